// The whole run on one line: a slider to go back to any time, of the same scale as the chart above it.

/** @import { Tiles } from "../stream/tiles.js" */
import { deedMoments } from "../stream/deeds.js";
import { spanOf } from "./agreement.js";
import { byId, element, setText } from "./dom.js";
import { deliberate } from "./slider.js";

const MS = 1000;
// A source that has not answered by then is asked again.
const PATIENCE_MS = 3000;
/** @type {Record<string, number>} */
const WAYS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 };

export class Timeline {
  /** @param {Pick<Tiles, "time" | "end" | "jumps" | "stepS"> & {deeds?: Tiles["deeds"]}} tiles @param {(seconds: number) => void} seek */
  constructor(tiles, seek) {
    this.tiles = tiles;
    this.seek = seek;
    this.root = byId("timeline");
    /** The time that is wanted next, in seconds. @type {number | null} */
    this.wanted = null;
    this.asked = { jumps: -1, until: 0, time: 0 };
    this.slider = element("input", {
      type: "range", min: 0, max: 1, value: 0, step: 1, id: "moment", "aria-label": "Time of the run", title: "Any time of the run; , and . go by one update",
      oninput: () => this.go(Number(this.slider.value) / MS),
      onkeydown: (/** @type {KeyboardEvent} */ event) => this.key(event),
    });
    deliberate(this.slider);
    this.words = element("output", { for: "moment", class: "speed-words" });
    this.deed = element("span", { class: "summary", role: "status" });
    this.root.append(this.slider, element("span", { class: "caption", "aria-hidden": "true" }, "Go back"), this.deed, this.words);
  }

  /** An arrow key is an update, which is more than a step of the slider. @param {KeyboardEvent} event */
  key(event) {
    const way = WAYS[event.key];
    if (!way) return;
    this.go(Math.min(this.aim + way * this.tiles.stepS, this.tiles.end ?? 0));
    event.preventDefault();
  }

  /** Goes to a time, as soon as the one before has come. @param {number} seconds */
  go(seconds) {
    this.wanted = Math.min(Math.max(0, seconds), this.tiles.end ?? 0);
    this.ask(performance.now());
  }

  /** The time of the run, or that which it is on its way to. */
  get aim() {
    return this.wanted ?? (this.isAsked(performance.now()) ? this.asked.time : this.tiles.time);
  }

  /** Whether an answer is on its way. @param {number} now */
  isAsked(now) {
    return this.asked.jumps === this.tiles.jumps && now < this.asked.until;
  }

  /** Asks for the wanted time, unless an answer is on its way. @param {number} now */
  ask(now) {
    if (this.wanted === null || this.isAsked(now)) return;
    this.asked = { jumps: this.tiles.jumps, until: now + PATIENCE_MS, time: this.wanted };
    this.seek(this.wanted);
    this.wanted = null;
  }

  /** @param {number} now */
  update(now) {
    const { tiles } = this;
    const span = spanOf(tiles);
    this.root.hidden = span === null;
    if (span === null || tiles.end === null) return;
    this.ask(now);
    this.slider.max = String(Math.ceil(span * MS));
    if (!this.isAsked(now) && this.wanted === null) this.slider.value = String(Math.round(tiles.time * MS));
    const words = `${tiles.time.toFixed(2)} of ${tiles.end.toFixed(2)} s`;
    setText(this.words, words);
    this.slider.setAttribute("aria-valuetext", words);
    const last = deedMoments(tiles.deeds ?? []).findLast(({ time }) => time <= tiles.time);
    setText(this.deed, last ? `${last.time.toFixed(2)} s: ${last.words}` : "");
  }
}
