// The commands of the page, checked and bounded: the twin of `tilenca.protocol.stream_commands`, which says what each
// of them does.
import { TilencaError } from "../module.js";
import { SIDES } from "./sides.js";

export const MAX_PLACE = 64;
export const MOST_TILES = 144;
const MOST_FAULTS = 32;
const MOST_DEEDS = 200;
const MAX_NAME = 256;
const MAX_SPEED = 1024;
const MIN_SPEED = 1e-5;
const MAX_SECONDS = 86_400;
const MOST_INSTRUCTIONS = 1000;
const MAX_SKEW_PPM = 100_000;

/** @typedef {{ do: string, [field: string]: any }} Command */
/** Says what is wrong; "" for nothing. @typedef {(value: unknown) => string} Check */

/** @param {number} low @param {number} high @returns {Check} */
const whole = (low, high) => (value) =>
  Number.isInteger(value) && Number(value) >= low && Number(value) <= high ? "" : `must be a whole number in ${low}..${high}`;

/** As Python's `:g` writes it. @param {number} value */
const brief = (value) =>
  value !== 0 && Math.abs(value) < 1e-4 ? value.toExponential().replace(/e-(\d)$/, "e-0$1") : String(value);

/** @param {number} low @param {number} high @param {boolean} [orZero] @returns {Check} */
const number = (low, high, orZero = false) => (value) => {
  const isIn = typeof value === "number" && ((value >= low && value <= high) || (orZero && value === 0));
  return isIn ? "" : `must be a number in ${brief(low)}..${brief(high)}${orZero ? " or 0" : ""}`;
};

/** @type {Check} */
const truth = (value) => (typeof value === "boolean" ? "" : "must be true or false");

/** @type {Check} */
const text = (value) => {
  const isText = typeof value === "string" && value.length > 0 && value.length <= MAX_NAME && !/[\p{C}]/u.test(value);
  return isText ? "" : `must be a text of 1 to ${MAX_NAME} characters`;
};

/** @type {Check} */
const side = (value) =>
  typeof value === "string" && value.length === 1 && SIDES.includes(value) ? "" : `must be one of ${[...SIDES].join(", ")}`;

const place = whole(-MAX_PLACE, MAX_PLACE);

/** @type {Check} */
const faults = (value) => {
  if (!Array.isArray(value) || value.length > MOST_FAULTS) return `must be a list of at most ${MOST_FAULTS} faults`;
  return value.map(text).find(Boolean) ?? "";
};

const distance = whole(-2 * MAX_PLACE, 2 * MAX_PLACE);

/** @type {Check} */
const ports = (value) => {
  if (!Array.isArray(value) || value.length > MOST_TILES) return `must be a list of at most ${MOST_TILES} ports`;
  return value.map(text).find(Boolean) ?? "";
};

/** @type {Check} */
const cells = (value) => {
  if (!Array.isArray(value) || value.length > MOST_TILES) return `must be a list of at most ${MOST_TILES} places`;
  for (const cell of value) {
    if (!Array.isArray(cell) || cell.length !== 2) return "must be places, [row, column] each";
    const wrong = place(cell[0]) || place(cell[1]);
    if (wrong) return wrong;
  }
  const different = new Set(value.map(String)).size;
  return different > 0 && different === value.length ? "" : `must be 1 to ${MOST_TILES} different places`;
};

/** @type {Check} */
const deeds = (value) => {
  if (!Array.isArray(value) || value.length > MOST_DEEDS) return `must be a list of at most ${MOST_DEEDS} deeds`;
  for (const deed of value) {
    const isDeed = Array.isArray(deed) && deed.length === 2 && typeof deed[1] === "object" && deed[1] !== null;
    if (!isDeed || Array.isArray(deed[1])) return "must be deeds, [seconds, command] each";
    const wrong = number(0, MAX_SECONDS)(deed[0]);
    if (wrong) return wrong;
    const { do: name } = deed[1];
    if (typeof name === "string" && Object.hasOwn(KINDS, name) && !HANDS.includes(name)) { // before its own deeds are read
      return `must be commands that change something, and ${name} does not`;
    }
    try {
      checked(deed[1]);
    } catch (error) {
      return error instanceof Error ? error.message : String(error);
    }
  }
  return "";
};

/** @type {Check} */
const untilS = (value) => (value === null ? "" : number(0, MAX_SECONDS)(value));
const speed = number(MIN_SPEED, MAX_SPEED, true);
/** The settings that a hand may change, and their ranges. @type {Record<string, [number, number]>} */
const SETTINGS = { period: [10, 10_000], updates: [0, 0xffff], brightness: [0, 255] };
/** @type {Check} */
const settingName = (value) =>
  typeof value === "string" && Object.hasOwn(SETTINGS, value) ? "" : `must be one of ${Object.keys(SETTINGS).join(", ")}`;
/** @type {Check} */
const portOrAll = (value) => (value === null ? "" : text(value));

/** Of each command its fields: how to check one, and what it is where it is left out. @type {Record<string, Record<string, [Check, unknown?]>>} */
const KINDS = {
  open: {
    cells: [cells], seed: [whole(0, Number.MAX_SAFE_INTEGER), 0], faults: [faults, []], spread_s: [number(0, 3600), 1],
    speed: [speed, 1], paused: [truth, false], until_s: [untilS, null],
    deeds: [deeds, []],
  },
  pace: { speed: [speed], paused: [truth, false] },
  rest: { on: [truth] },
  step: { seconds: [number(16e-6, 10)] },
  seek: { seconds: [number(0, MAX_SECONDS)], forget: [truth, false] },
  instruct: { port: [text], count: [whole(0, MOST_INSTRUCTIONS), 1] },
  put: { row: [place], col: [place] },
  pull: { port: [text] },
  move: { port: [text], row: [place], col: [place] },
  shift: { ports: [ports], rows: [distance], cols: [distance] },
  arrange: { cells: [cells] },
  cut: { port: [text], side: [side], on: [truth, true] },
  power: { port: [text], on: [truth] },
  freeze: { port: [text], on: [truth, true] },
  turn: { port: [text], on: [truth, true] },
  skew: { port: [text], ppm: [number(-MAX_SKEW_PPM, MAX_SKEW_PPM)] },
  reset: { port: [text] },
  noise: { loss: [number(0, 1)] },
  blink: { port: [text], seconds: [whole(0, 60), 5] },
  restart: { port: [text] },
  set: { name: [settingName], value: [whole(0, 0xffff)], port: [portOrAll, null] },
  seen: { batch: [whole(0, Number.MAX_SAFE_INTEGER)] },
};

/** Those that change something. */
const HANDS = [
  "put", "pull", "move", "shift", "arrange", "cut", "power", "freeze", "turn", "skew", "reset", "noise", "blink", "restart", "set",
];

/**
 * The command with all its fields.
 * @param {Command} given
 * @returns {Command}
 * @throws {TilencaError} it is none; in words that a person understands
 */
export function checked(given) {
  const { do: name, ...fields } = given;
  const kind = Object.hasOwn(KINDS, name) ? KINDS[name] : undefined;
  if (kind === undefined) throw new TilencaError(`a command has "do", one of: ${Object.keys(KINDS).join(", ")}`);
  /** @type {Command} */
  const command = { do: name };
  for (const [field, [check, ...otherwise]] of Object.entries(kind)) {
    if (field in fields) {
      const wrong = check(fields[field]);
      if (wrong) throw new TilencaError(`${name}: ${field} ${wrong}`);
      command[field] = fields[field];
    } else if (otherwise.length === 0) {
      throw new TilencaError(`${name}: ${field} is missing`);
    } else {
      command[field] = otherwise[0];
    }
  }
  const strange = Object.keys(fields).find((field) => !(field in kind));
  if (strange !== undefined) throw new TilencaError(`${name}: it has no '${strange.slice(0, MAX_NAME)}'`);
  const wrong = name === "set" ? whole(...SETTINGS[command.name])(command.value) : "";
  if (wrong) throw new TilencaError(`${name}: value ${wrong}`);
  return command;
}
