// The colour in which a screen shows an LED, twin of `screen_colour` in host/tilenca/shapes/glyphs.py: screens
// show LEDs as bright as it gets, since they are dim and screens are not, and a little pale.

const GAMMA = 1.6;
const PALENESS = 0.3;
const PEAK = 0.94;
const SHADE = 0.68;
const CONTRAST = 3; // of a colour to the ground

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

/** How bright a colour is, of 0 to 1, as contrasts are reckoned (WCAG 2). @param {number[]} colour red, green, blue, 0..255 */
function luminance(colour) {
  const [red, green, blue] = colour.map((part) => (part <= 10 ? part / 3295 : ((part / 255 + 0.055) / 1.055) ** 2.4));
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

/** A label's colour, as pale as it has to be to be seen on the dark ground. @param {number[]} duty @param {number[]} ground 0..255 each */
export function seenColour(duty, ground) {
  const colour = screenColour(duty);
  const least = CONTRAST * (luminance(ground) + 0.05) - 0.05;
  for (let share = 0; ; share += 0.05) {
    const mixed = colour.map((part) => Math.round(part + (255 - part) * share));
    if (luminance(mixed) >= least || share >= 1) return `rgb(${mixed.join(" ")})`;
  }
}
