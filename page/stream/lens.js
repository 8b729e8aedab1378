// What the colours of the tiles tell: their LEDs, how sure they are, or one number of their states.

/** @import { Look } from "./source.js" */
/** @import { Tile } from "./tile.js" */
/** @import { Tiles } from "./tiles.js" */
import { MESSAGE_OFFSET } from "./sentences.js";

export const FULL = 127; // the largest message
// A margin can be 254, but tiles that have agreed have about so much.
const SURE = 64;

/** Of a scale from its low end to its high one: red, green and blue. @typedef {[number, number, number][]} Ramp */

/** @type {Ramp} */
const FROM_NOTHING = [[34, 36, 58], [84, 58, 120], [168, 72, 112], [233, 122, 66], [252, 215, 110]];
/** @type {Ramp} */
const BOTH_WAYS = [[84, 170, 255], [44, 92, 160], [38, 40, 46], [164, 82, 34], [255, 162, 72]];

/**
 * A way to colour tiles.
 * @typedef {{
 *   id: string, group: string, name: string, unit: string, low: number, high: number, ends: [string, string], ramp: Ramp,
 *   valueOf: (tile: Tile) => number | null,
 * }} Lens with the ends of its scale in words
 */

/**
 * What each number of a tile's state is: first the hidden channels, then the scores of the classes.
 * @param {{channels: number, classes: number}} tile
 * @param {Look[]} looks
 * @returns {{name: string, look: Look | undefined}[]}
 */
export function channelsOf({ channels, classes }, looks) {
  const hidden = Math.max(0, channels - classes);
  return Array.from({ length: channels }, (_, index) => {
    const look = index < hidden ? undefined : looks[index - hidden];
    return { name: look ? look.label : String(index + 1), look };
  });
}

/** How sure a tile is. @type {Lens} */
const SURENESS = {
  id: "sure", group: "", name: "How sure", unit: "margin", low: 0, high: SURE, ends: ["torn 0", `sure ${SURE} or more`], ramp: FROM_NOTHING,
  valueOf: (tile) => tile.margin,
};

/** All that there are for these tiles; of several models, those of the first tile that has spoken. @param {Tiles} tiles @returns {Lens[]} */
export function lensesFor(tiles) {
  const first = tiles.laid().find((tile) => tile.channels > 0);
  const channels = first ? channelsOf(first, tiles.looks) : [];
  return [SURENESS, ...channels.map(({ name, look }, index) => /** @type {Lens} */ ({
    id: look ? `score-${name}` : `channel-${name}`,
    group: look ? "Scores" : "Hidden channels",
    name: look ? `Score of ${name}` : `Channel ${name}`,
    unit: look ? `score of ${name}` : `channel ${name}`,
    low: -FULL, high: FULL, ends: [`−${FULL}`, `+${FULL}`], ramp: BOTH_WAYS,
    valueOf: (/** @type {Tile} */ tile) => (index < tile.state.length ? tile.state[index] - MESSAGE_OFFSET : null),
  }))];
}

/** What a tile tells through a lens; null where it tells nothing. @param {Lens} lens @param {Tile} tile */
export function seenThrough(lens, tile) {
  return tile.powered && tile.place ? lens.valueOf(tile) : null;
}

/** The colour of a value. @param {Lens} lens @param {number} value @returns {[number, number, number]} */
export function shadeOf({ low, high, ramp }, value) {
  const at = Math.min(1, Math.max(0, (value - low) / (high - low))) * (ramp.length - 1);
  const from = Math.min(Math.floor(at), ramp.length - 2);
  const [one, other] = [ramp[from], ramp[from + 1]];
  const [red, green, blue] = one.map((part, index) => Math.round(part + (other[index] - part) * (at - from)));
  return [red, green, blue];
}

/** Of a colour, as the eye takes it, 0..1 (WCAG's relative luminance). @param {number[]} rgb */
export function luminance(rgb) {
  const [red, green, blue] = rgb.map((part) => {
    const share = part / 255;
    return share <= 0.03928 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

/** Black or white, whatever is read better on a colour: they are alike at a luminance of 0.18. @param {number[]} rgb */
export const inkOn = (rgb) => (luminance(rgb) > 0.18 ? "#101114" : "#ffffff");
