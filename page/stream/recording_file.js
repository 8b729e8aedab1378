// The file of a recording (docs/PROTOCOL.md section 7): every event is checked before anything of it is shown.
// Its twin is host/tilenca/page/recording_file.py.

/** @import { StreamEvent } from "./source.js" */
import { SIDES, STREAM_VERSION } from "./source.js";

const MOST_EVENTS = 2_000_000;
const LONGEST_S = 1e7;
const MOST_PLACE = 1000;
const MOST_PERIOD_MS = 60_000;
const BEGINNING = 2; // lines that each one has
const CHOOSE = "choose a recording (.jsonl)";

/** @typedef {(value: any, event: any) => boolean} Check */

/** @param {unknown} value @param {number} low @param {number} high */
const isIn = (value, low, high) => typeof value === "number" && value >= low && value <= high;
/** @param {unknown} value @param {number} low @param {number} high */
const isWhole = (value, low, high) => Number.isInteger(value) && isIn(value, low, high);
/** @param {any} value */
const isObject = (value) => typeof value === "object" && value !== null && !Array.isArray(value);
/** @param {unknown} value */
const isText = (value) => typeof value === "string" && value.length <= 4096;
/** @param {any} value */
const isColour = (value) => Array.isArray(value) && value.length === 3 && value.every((part) => isWhole(part, 0, 255));
/** @param {any} value */
const isSide = (value) => typeof value === "string" && value.length === 1 && SIDES.includes(value);
/** @param {any} look */
const isLook = (look) => isObject(look) && isText(look.label) && isWhole(look.segments, 0, 255) && isColour(look.rgb);
/** @param {any} value @param {Check} check */
const isListOf = (value, check) => Array.isArray(value) && value.length <= 4096 && value.every((one) => check(one, null));
/** @param {any} drawing */
const isDrawing = (drawing) =>
  isObject(drawing) && isText(drawing.name) && isText(drawing.label) && isListOf(drawing.rows, isText) && drawing.rows.length > 0;
/** @param {any} model */
const isModel = (model) => isObject(model) && isText(model.name) && isText(model.id) && isListOf(model.labels, isText);
/** Of the first event. @param {any} event */
const isStream = ({ source, of = "", model = "", models = [], looks = [], drawings = [], most_tiles = 0, most_place = 0, ...event }) =>
  [source, of, model].every(isText) && isListOf(models, isModel) && isListOf(looks, isLook) && isListOf(drawings, isDrawing) &&
  isWhole(most_tiles, 0, MOST_PLACE ** 2) && isWhole(most_place, 0, MOST_PLACE) && isIn(event.period_ms ?? 1, 1, MOST_PERIOD_MS);
/** @param {any} link */
const isLink = (link) => Array.isArray(link) && link.length === 2 && isText(link[0]) && (link[1] === null || isIn(link[1], 0, 1));

/** @param {any} value */
const isPlain = (value) => value === null || typeof value === "boolean" || Number.isFinite(value) || isText(value);
/** What a deed may be given. @param {any} value */
const isGiven = (value) => isPlain(value) || isListOf(value, (one) => isPlain(one) || isListOf(one, isPlain));

/** What each subject must be, and which of them are about a tile. @type {Record<string, [Check, boolean]>} */
const SUBJECTS = {
  stream: [(_, event) => isStream(event), false],
  run: [(run) => isObject(run) && isIn(run.seed, 0, Number.MAX_SAFE_INTEGER) && isIn(run.began ?? 0, 0, 1e12), false],
  jump: [(jump) => isObject(jump) && isIn(jump.from, 0, LONGEST_S), false],
  pace: [(pace) => isObject(pace) && isIn(pace.speed, 0, 1024) && isIn(pace.end ?? 0, 0, LONGEST_S), false],
  deed: [(deed) => isObject(deed) && isText(deed.do) && Object.values(deed).every(isGiven), false],
  classes: [(looks) => isListOf(looks, isLook), false],
  refused: [isText, false],
  place: [(place) => place === null || (isListOf(place, (one) => isWhole(one, -MOST_PLACE, MOST_PLACE)) && place.length === 2), true],
  cable: [(cable, event) => ["cut", "whole"].includes(cable) && isSide(event.side), true],
  fault: [(fault) => isObject(fault) && typeof fault.turned === "boolean" && isIn(fault.skew, -1e6, 1e6), true],
  raw: [isText, true],
  open: [(open, event) => typeof open === "boolean" && isText(event.reason ?? ""), true],
  display: [(show) => isObject(show) && isWhole(show.segments, 0, 255) && isColour(show.rgb) && isText(show.leds) && show.leds.length === 4, true],
  frame: [(frame, event) => isText(frame) && /^([0-9a-f]{2})*$/i.test(frame) && isSide(event.side), true],
  health: [
    (health) => isObject(health) && isText(health.trouble) && isObject(health.links) &&
      Object.entries(health.links).every(([side, link]) => isSide(side) && isLink(link)),
    true,
  ],
  note: [isText, true],
};

/**
 * What is wrong with an event; "" for nothing.
 * @param {any} event
 */
function wrongWith(event) {
  if (!isObject(event) || !isIn(event.time, 0, LONGEST_S)) return "is no event";
  const subjects = Object.keys(SUBJECTS).filter((name) => name in event);
  if (subjects.length > 1) return `tells of ${subjects.join(" and ")} at once`;
  const [name] = subjects;
  if (name === undefined) return ""; // of a later version: it is passed over
  const [check, isOfTile] = SUBJECTS[name];
  if (isOfTile && !(isText(event.port) && event.port)) return `tells of a ${name}, and not of which tile`;
  return check(event[name], event) ? "" : `tells of a ${name} that cannot be`;
}

/** @param {string} line @returns {any} */
function parsed(line) {
  try {
    return JSON.parse(line);
  } catch {
    return null;
  }
}

/**
 * The events of a file, in order of time: the first one of the stream, and those of the run. A last line that was cut
 * off, since whoever wrote it was stopped, is left out.
 * @param {string} text
 * @returns {{events: StreamEvent[], isCut: boolean}}
 * @throws {Error} it is none; in words for a person
 */
export function parseRecording(text) {
  /** @type {StreamEvent[]} */
  const events = [];
  const lines = text.split("\n");
  let number = 0;
  let isCut = false;
  for (const line of lines) {
    number++;
    if (/^[ \t\r]*$/.test(line)) continue;
    const event = parsed(line);
    isCut = event === null && number === lines.length && number > BEGINNING;
    if (isCut) break;
    if (events.length === 0 && isObject(event) && event.port !== undefined) {
      throw new Error("it is of --record, and not of the page: tilenca page --replay shows it");
    }
    if (events.length === 0 && isObject(event) && event.stream !== undefined && event.stream !== STREAM_VERSION) {
      throw new Error(`it has version ${event.stream} of the stream, this page ${STREAM_VERSION}`);
    }
    const wrong = wrongWith(event);
    if (wrong) throw new Error(`line ${number} ${wrong}; ${CHOOSE}`);
    if (events.push(event) > MOST_EVENTS) throw new Error(`it has more than ${MOST_EVENTS} events`);
  }
  const [first, run, ...rest] = events;
  if (first?.stream === undefined || !run?.run) throw new Error(`it does not begin as a recording of the page does; ${CHOOSE}`);
  if (rest.some((event) => event.run || event.stream !== undefined)) throw new Error(`it has more than one run; ${CHOOSE}`);
  return { events: [first, run, ...rest.sort((one, other) => one.time - other.time)], isCut };
}
