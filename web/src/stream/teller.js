// What the page is told of a board: all that is news, and after a jump in time all that there is: the twin of
// `tilenca.page.teller`.
import { sorted } from "./faults.js";
import { Lines } from "./lines.js";
import { SIDES } from "./sides.js";
import { subjectOf } from "./subject.js";

const NO_POWER = "no power";
const RESTARTED = "it starts anew";
const MOST_REFUSAL = 300; // characters
const UNSPOILT = JSON.stringify({ turned: false, skew: 0 });

/** @typedef {{ time: number, [subject: string]: unknown }} StreamEvent */
/** What the page was told of a tile. @typedef {{ place: string, powered: boolean | null, startedS: number | null, fault: string, display: string }} Seen */
/** What a tile has said: the beginning of its next line, and its last line of each kind. @typedef {{ lines: Lines, last: Map<string, StreamEvent> }} Voice */

/** @param {number} time @param {Record<string, unknown>} about @returns {StreamEvent} */
export const event = (time, about) => ({ time: Number(time.toFixed(6)), ...about });

/** A command was not carried out; the reason is cut where it is long. @param {string} reason @returns {StreamEvent} */
export const refused = (reason) => ({ time: 0, refused: reason.slice(0, MOST_REFUSAL) });

/** @param {number} index */
export const portName = (index) => `tile-${String(index + 1).padStart(2, "0")}`;

/** @param {number} one @param {number} other */
const byPort = (one, other) => (portName(one) < portName(other) ? -1 : Number(one !== other));

/** Looks at a board, and tells the page. */
export class Teller {
  /** @type {Seen[]} */
  #seen = [];
  /** The cables that the page knows to be cut. @type {import("../array.js").Link[]} */
  #cut = [];
  /** @type {Voice[]} */
  #voices = [];

  /** @param {import("./board.js").Board} board */
  constructor(board) {
    this.board = board;
  }

  /** What lies where, has power, shines and is joined, as far as it is news. */
  places() {
    const { array, places, cut, faults } = this.board;
    const now = array.timeS;
    /** @type {StreamEvent[]} */
    const events = [];
    while (this.#seen.length < array.size) this.#seen.push({ place: "", powered: null, startedS: null, fault: UNSPOILT, display: "" });
    while (this.#voices.length < array.size) this.#voices.push({ lines: new Lines(), last: new Map() });
    this.#seen.forEach((seen, index) => {
      const [port, place, { powered }] = [portName(index), places.get(index), array.tile(index)];
      if ((place?.join() ?? "") !== seen.place) {
        seen.place = place?.join() ?? "";
        events.push(event(now, { port, place: place ? [...place] : null }));
      }
      const startedS = this.#startedS(index);
      const isAnew = ![null, startedS].includes(seen.startedS);
      seen.startedS = startedS;
      if (place && powered && seen.powered && isAnew) {
        seen.powered = false; // what it showed is over
        events.push(event(now, { port, open: false, reason: RESTARTED }));
      }
      if (place && powered !== seen.powered) {
        seen.powered = powered;
        events.push(event(now, { port, open: powered, reason: powered ? "" : NO_POWER }));
      }
      const fault = { turned: faults.turned.has(index), skew: Number((faults.skewed.get(index) ?? 0).toFixed(3)) };
      if (JSON.stringify(fault) !== seen.fault) {
        seen.fault = JSON.stringify(fault);
        events.push(event(now, { port, fault }));
      }
      const tile = array.tile(index);
      const leds = [...SIDES].map((name, side) => ((tile.leds >> side) & 1 ? name : "-")).join("");
      const display = { segments: tile.segments, rgb: [...tile.rgb], leds };
      if (JSON.stringify(display) !== seen.display) {
        seen.display = JSON.stringify(display);
        events.push(event(now, { port, display }));
      }
    });
    const [before, after] = [this.#cut, cut].map((links) => new Set(links.map(String)));
    const news = [...this.#cut, ...cut].filter((link) => before.has(String(link)) !== after.has(String(link)));
    for (const link of sorted(news)) {
      const cable = after.has(String(link)) ? "cut" : "whole";
      events.push(event(now, { port: portName(link[0]), side: SIDES[link[1]], cable }));
    }
    this.#cut = cut;
    return events;
  }

  /** All that is news; with `frames`, the frames on the cables, too. @param {boolean} frames */
  look(frames) {
    const { traffic } = this.board;
    const events = this.places();
    const passed = traffic.read();
    for (const { timeS, tile, side, data } of frames ? passed : []) {
      events.push(event(timeS, { port: portName(tile), side: SIDES[side], frame: data }));
    }
    const lines = this.#lines();
    const [old, fresh] = [true, false].map((wanted) =>
      lines.flatMap(({ index, told }) => (this.#isOver(index, told) === wanted ? [told] : [])));
    return [...old, ...events, ...fresh];
  }

  /** When a tile was switched on or reset last; below 0 where it never was since the beginning. @param {number} index */
  #startedS(index) {
    return this.board.faults.restarted.get(index) ?? -1;
  }

  /** Whether a line tells what a tile showed before it was switched on or reset last. @param {number} index @param {StreamEvent} told */
  #isOver(index, told) {
    return String(told.raw).startsWith("$TILE,") && told.time <= this.#startedS(index);
  }

  #lines() {
    const said = this.#voices.flatMap(({ lines, last }, index) => {
      const tile = this.board.array.tile(index);
      for (let got = tile.receive(); got.values.length > 0; got = tile.receive()) lines.feed(got.values, got.times);
      return lines.take().map(({ timeS, raw }) => {
        const told = event(timeS, { port: portName(index), raw });
        last.set(subjectOf(raw), told);
        return { timeS, index, told };
      });
    });
    return said.sort((one, two) => one.timeS - two.timeS || byPort(one.index, two.index));
  }

  // --- moments ---

  /** What the tiles have said until now. */
  save() {
    return this.#voices.map(copied);
  }

  /** The board has gone to the moment of a `save`: forgets what the page knows. @param {Voice[]} said */
  restore(said) {
    const { array } = this.board;
    for (let tile = 0; tile < array.size; tile++) array.tile(tile).readSerial(); // of the future that is left
    this.#voices = said.map(copied);
    this.#forget();
  }

  #forget() {
    this.#seen = [];
    this.#cut = [];
  }

  /** Everything, for a page that knows nothing; lines have the times at which they were said. */
  all() {
    this.#forget();
    this.look(false);
    const said = this.#voices.flatMap(({ last }, index) =>
      [...last.values()].flatMap((told) => (this.#isOver(index, told) ? [] : [{ index, told }])));
    said.sort((one, two) => one.told.time - two.told.time || byPort(one.index, two.index));
    this.#forget();
    return [...this.places(), ...said.map(({ told }) => told), ...this.look(false)];
  }
}

// What a copy of a voice takes.
export const VOICE_BYTES = 600;

/** @param {Voice} voice @returns {Voice} */
const copied = ({ lines, last }) => ({ lines: lines.copy(), last: new Map(last) });
