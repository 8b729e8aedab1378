// The whole run on one line: a slider to go back to any time, with a mark wherever a tile changed its mind.

/** @import { Tiles } from "../stream/tiles.js" */
import { cssColour } from "../stream/led.js";
import { byId, element, setText } from "./dom.js";

const MS = 1000;
const THUMB = 16; // pixels; the slider's ends are half of it away from those of its box
const MARKS_HIGH = 8;
// A source that has not answered by then is asked again.
const PATIENCE_MS = 3000;
/** @type {Record<string, number>} */
const WAYS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 };

export class Timeline {
  /** @param {Tiles} tiles @param {(seconds: number) => void} seek */
  constructor(tiles, seek) {
    this.tiles = tiles;
    this.seek = seek;
    this.root = byId("timeline");
    /** The time that is wanted next, in seconds. @type {number | null} */
    this.wanted = null;
    this.asked = { jumps: -1, until: 0, time: 0 };
    this.drawn = "";
    this.canvas = element("canvas", { "aria-hidden": "true" });
    this.pen = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d"));
    this.slider = element("input", {
      type: "range", min: 0, max: 1, value: 0, step: 1, id: "moment", "aria-label": "Time of the run", title: "Any time of the run; , and . go by one update",
      oninput: () => this.go(Number(this.slider.value) / MS),
      onkeydown: (/** @type {KeyboardEvent} */ event) => this.key(event),
    });
    this.words = element("output", { for: "moment", class: "speed-words" });
    this.root.append(element("span", { class: "caption", "aria-hidden": "true" }, "Go back"), element("div", { class: "track" }, this.canvas, this.slider), this.words);
    new ResizeObserver(() => {
      this.drawn = "";
    }).observe(this.canvas);
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
    this.wanted = Math.max(0, seconds);
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
    this.root.hidden = tiles.end === null;
    if (tiles.end === null) return;
    this.ask(now);
    this.slider.max = String(Math.max(1, Math.ceil(tiles.end * MS)));
    if (!this.isAsked(now) && this.wanted === null) this.slider.value = String(Math.round(tiles.time * MS));
    const words = `${tiles.time.toFixed(2)} of ${tiles.end.toFixed(2)} s`;
    setText(this.words, words);
    this.slider.setAttribute("aria-valuetext", words);
    this.draw();
  }

  draw() {
    const { canvas, pen, tiles } = this;
    const width = canvas.clientWidth;
    const state = `${width} ${tiles.history.changes.length} ${tiles.history.changes.at(-1)?.time} ${tiles.end}`;
    if (!width || state === this.drawn || tiles.end === null) return;
    this.drawn = state;
    const ratio = Math.min(devicePixelRatio || 1, 2);
    canvas.width = Math.round(width * ratio);
    canvas.height = MARKS_HIGH * ratio;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    const span = Math.max(tiles.end, 1e-3);
    for (const { time, from, to } of tiles.history.changes) {
      if (from === "" || to === "") continue;
      pen.fillStyle = cssColour(tiles.look(to).rgb);
      pen.fillRect(THUMB / 2 + (time / span) * (width - THUMB) - 1, 0, 2, MARKS_HIGH);
    }
  }
}
