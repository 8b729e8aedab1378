// The colour in which a screen shows an LED, twin of `screen_colour` in host/tilenca/shapes/glyphs.py: screens
// show LEDs as bright as it gets, since they are dim and screens are not, and a little pale.

const GAMMA = 1.6;
const PALENESS = 0.3;
const PEAK = 0.94;
const SHADE = 0.68;

/** The authors' ten colours of classes, duty of 255. */
export const PAPER_COLOURS = [
  [20, 20, 20], [0, 20, 0], [0, 0, 30], [70, 25, 0], [5, 50, 30],
  [40, 12, 60], [50, 50, 0], [55, 0, 0], [75, 25, 30], [25, 15, 15],
];

/** How often a colour was dimmed; where two are the same, the brighter one counts. @type {Map<string, number>} */
const DIMMED = new Map();
for (let times = 2; times >= 0; times--) {
  for (const colour of [...PAPER_COLOURS].reverse()) {
    DIMMED.set(colour.map((part) => Math.ceil(part / 3 ** times)).join(), times);
  }
}

/**
 * @param {number[]} duty red, green, blue, 0..255
 * @returns {[number, number, number]} 0..255 each
 */
export function screenColour(duty) {
  const strongest = Math.max(...duty);
  if (strongest === 0) return [0, 0, 0];
  const shade = SHADE ** (DIMMED.get(duty.join()) ?? 0);
  const [red, green, blue] = duty.map((part) => {
    const lifted = (part / strongest) ** (1 / GAMMA);
    return Math.round(255 * shade * (PALENESS + (PEAK - PALENESS) * lifted));
  });
  return [red, green, blue];
}

/** The same for a style sheet. @param {number[]} duty */
export function cssColour(duty) {
  return `rgb(${screenColour(duty).join(" ")})`;
}
