// What hands did and when, as an address has it: `0.65,pull,4` or `0.7,cut,3W,1`.

/** @import { Command, Place } from "./source.js" */
import { cellsOf, rowsOf } from "./drawing.js";
import { sideWords } from "./source.js";

/** @typedef {{time: number, deed: Command}} Deed */

export const MOST_DEEDS = 200;
export const MOST_TEXT = 16_000; // characters of a command that begins a run; the server takes a little more

/** @param {unknown} port "tile-04" */
const numberOf = (port) => Number(String(port).replace(/^\D*/, ""));
/** @param {string} text */
const portOf = (text) => `tile-${text.padStart(2, "0")}`;
/** @param {unknown} on */
const digit = (on) => (on ? 1 : 0);

/** @param {Place[]} cells */
function boardText(cells) {
  const corner = [0, 1].map((axis) => Math.min(...cells.map((cell) => cell[axis])));
  return [rowsOf(cells).join("-"), ...corner].join(",");
}

/** @type {Record<string, {write: (deed: any) => unknown[], read: (words: string[]) => object}>} */
const KINDS = {
  put: { write: ({ row, col }) => [row, col], read: ([row, col]) => ({ row: Number(row), col: Number(col) }) },
  pull: { write: ({ port }) => [numberOf(port)], read: ([tile]) => ({ port: portOf(tile) }) },
  move: {
    write: ({ port, row, col }) => [numberOf(port), row, col],
    read: ([tile, row, col]) => ({ port: portOf(tile), row: Number(row), col: Number(col) }),
  },
  shift: {
    write: ({ ports, rows, cols }) => [ports.map(numberOf).join("-"), rows, cols],
    read: ([tiles, rows, cols]) => ({ ports: tiles.split("-").map(portOf), rows: Number(rows), cols: Number(cols) }),
  },
  arrange: {
    write: ({ cells }) => [boardText(cells)],
    read: ([rows, top, left]) => ({
      cells: cellsOf(rows.split("-")).map(([row, col]) => [row + Number(top), col + Number(left)]),
    }),
  },
  cut: {
    write: ({ port, side, on }) => [`${numberOf(port)}${side}`, digit(on)],
    read: ([end, on]) => ({ port: portOf(end.slice(0, -1)), side: end.slice(-1), on: on === "1" }),
  },
  power: { write: ({ port, on }) => [numberOf(port), digit(on)], read: ([tile, on]) => ({ port: portOf(tile), on: on === "1" }) },
  freeze: { write: ({ port, on }) => [numberOf(port), digit(on)], read: ([tile, on]) => ({ port: portOf(tile), on: on === "1" }) },
  turn: { write: ({ port, on }) => [numberOf(port), digit(on)], read: ([tile, on]) => ({ port: portOf(tile), on: on === "1" }) },
  skew: { write: ({ port, ppm }) => [numberOf(port), ppm], read: ([tile, ppm]) => ({ port: portOf(tile), ppm: Number(ppm) }) },
  reset: { write: ({ port }) => [numberOf(port)], read: ([tile]) => ({ port: portOf(tile) }) },
  noise: { write: ({ loss }) => [loss], read: ([loss]) => ({ loss: Number(loss) }) },
  blink: {
    write: ({ port, seconds }) => [numberOf(port), seconds],
    read: ([tile, seconds]) => ({ port: portOf(tile), seconds: Number(seconds) }),
  },
  restart: { write: ({ port }) => [numberOf(port)], read: ([tile]) => ({ port: portOf(tile) }) },
  set: {
    write: ({ name, value, port }) => [name, value, ...(port === null ? [] : [numberOf(port)])],
    read: ([name, value, tile]) => ({ name, value: Number(value), port: tile === undefined ? null : portOf(tile) }),
  },
};

/** @param {unknown} port */
const tileWords = (port) => `tile ${numberOf(port)}`;
/** @param {unknown} list */
const lengthOf = (list) => (Array.isArray(list) ? list.length : 0);

/** What each of them is in words, as what has happened. @type {Record<string, (deed: any) => string>} */
const WORDS = {
  put: () => "a tile put in",
  pull: ({ port }) => `${tileWords(port)} pulled out`,
  move: ({ port }) => `${tileWords(port)} moved`,
  shift: ({ ports }) => (lengthOf(ports) === 1 ? `${tileWords(ports[0])} moved` : `${lengthOf(ports)} tiles moved together`),
  arrange: ({ cells }) => `another drawing, of ${lengthOf(cells)} ${lengthOf(cells) === 1 ? "tile" : "tiles"}`,
  cut: ({ port, side, on }) => `cable ${on ? "cut" : "mended"} at ${tileWords(port)}, ${sideWords(side)}`,
  power: ({ port, on }) => `${tileWords(port)} switched ${on ? "on" : "off"}`,
  freeze: ({ port, on }) => `${tileWords(port)} ${on ? "frozen" : "thawed"}`,
  turn: ({ port, on }) => `${tileWords(port)} ${on ? "turned" : "turned back"}`,
  skew: ({ port, ppm }) => `the clock of ${tileWords(port)} ${ppm ? `${Math.abs(ppm)} ppm too ${ppm > 0 ? "fast" : "slow"}` : "right again"}`,
  reset: ({ port }) => `${tileWords(port)} reset`,
  noise: ({ loss }) => (loss ? `${Number((100 * loss).toFixed(1))} % of the bytes lost` : "no byte lost any more"),
  blink: ({ port }) => `${tileWords(port)} blinks`,
  restart: ({ port }) => `the button of ${tileWords(port)} pressed`,
  set: ({ name, value, port }) => `${name} ${value} set at ${port === null ? "all tiles" : tileWords(port)}`,
};

/** A deed in a few words. @param {Command} deed */
const deedWords = (deed) => (Object.hasOwn(WORDS, deed.do) ? WORDS[deed.do](deed) : deed.do);

const SAME_S = 1e-4; // what was done while time stood is one
const MOST_WORDS = 2;

/** @typedef {{time: number, words: string}} Moment */

const told = /** @type {WeakMap<Deed[], Moment[]>} */ (new WeakMap());

/**
 * The deeds of each moment as one, in words; those of the beginning are none. Every frame asks for them.
 * @param {Deed[]} deeds a list that stays as it is
 * @returns {Moment[]}
 */
export function deedMoments(deeds) {
  const known = told.get(deeds);
  if (known) return known;
  const found = momentsOf(deeds);
  told.set(deeds, found);
  return found;
}

/** @param {Deed[]} deeds @returns {Moment[]} */
function momentsOf(deeds) {
  /** @type {{time: number, all: string[]}[]} */
  const moments = [];
  for (const { time, deed } of deeds) {
    const last = moments.at(-1);
    if (time <= SAME_S) continue;
    if (last && time - last.time < SAME_S) last.all.push(deedWords(deed));
    else moments.push({ time, all: [deedWords(deed)] });
  }
  return moments.map(({ time, all }) => {
    const more = all.length - MOST_WORDS;
    return { time, words: [...all.slice(0, MOST_WORDS), ...(more > 0 ? [`${more} more`] : [])].join(", ") };
  });
}

/** Whether a command changes what the tiles do from then on. @param {Command} command */
export const isDeed = (command) => Object.hasOwn(KINDS, command.do);

/** @param {Deed} deed */
export function deedText({ time, deed }) {
  return [time, deed.do, ...KINDS[deed.do].write(deed)].join(",");
}

/**
 * The deed that a part of an address tells of; none where it is nonsense.
 * @param {string} text
 * @returns {Deed[]}
 */
export function parseDeed(text) {
  const [time, name, ...words] = text.split(",");
  const kind = Object.hasOwn(KINDS, name ?? "") ? KINDS[name] : undefined;
  if (!kind || !/^\d+(\.\d+)?$/.test(time) || words.length < 1) return [];
  return [{ time: Number(time), deed: { do: name, ...kind.read(words) } }];
}
