// Agreement over time: what share of the tiles showed what, and a mark for every change of mind.

/** @import { Look } from "../stream/source.js" */
/** @import { Tiles } from "../stream/tiles.js" */
import { seenColour } from "../stream/led.js";
import { byId, setText } from "./dom.js";

// What is in view of tiles whose time does not go back, in seconds of the wall clock.
const WINDOW_S = 24;
const LEAST_S = 1; // of a run in view
const EDGE = 8; // pixels left and right: half the thumb of the slider below, which has the same scale
const STEPS = [1, 2, 5];
const MARKS = 13; // pixels for the marks below the bands
const AXIS = 17;
const DRAW_MS = 90;

/** The distance of lines at a time axis: a round one. @param {number} span @param {number} most */
export function roundStep(span, most) {
  for (let power = -5; ; power++) {
    for (const step of STEPS) {
      const size = step * 10 ** power;
      if (span / size <= most) return size;
    }
  }
}

/** @param {number} seconds @param {number} step */
function timeText(seconds, step) {
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return `${seconds.toFixed(digits)} s`;
}

/** The times at both ends of the chart and of the slider below it; null: time does not go back here. @param {Tiles} tiles */
export const spanOf = ({ end }) => (end === null ? null : Math.max(end, LEAST_S));

/** @typedef {{text: string, line: string, band: string, font: string, ground: string}} Ink */

/** @param {Element} canvas @returns {Ink} */
function inkOf(canvas) {
  const style = getComputedStyle(canvas);
  /** @param {string} name */
  const value = (name) => style.getPropertyValue(name);
  return { text: value("--ink-soft"), line: value("--line"), band: value("--unlit-band"), font: style.font, ground: value("--ground") };
}

export class Agreement {
  /** @param {Tiles} tiles @param {(seconds: number) => void} go to a time of the run */
  constructor(tiles, go) {
    this.tiles = tiles;
    this.canvas = /** @type {HTMLCanvasElement} */ (byId("agreement"));
    this.pen = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d"));
    this.text = byId("agreement-text");
    this.drawn = 0;
    /** The times of both ends. */
    this.view = { begin: 0, span: 1 };
    /** How each label is seen on the ground. @type {Map<string, string>} */
    this.colours = new Map();
    /** @type {Look[] | null} */
    this.looks = null;
    this.canvas.addEventListener("click", (event) => {
      if (tiles.end !== null) go(Math.min(this.timeAt(event.offsetX), tiles.end));
    });
    this.lastRate = 1;
    /** Colours and font of the style sheet, until they may have changed. @type {Ink | null} */
    this.ink = null;
    const forget = () => {
      this.ink = null;
      this.drawn = 0;
    };
    new ResizeObserver(forget).observe(this.canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", forget);
  }

  /** @param {number} now */
  update(now) {
    if (now - this.drawn < DRAW_MS) return;
    this.drawn = now;
    const { tiles } = this;
    const { counts, total } = tiles.count();
    const most = Math.max(0, ...[...counts].filter(([label]) => label).map(([, count]) => count));
    const share = total ? Math.round((100 * most) / total) : 0;
    const changes = tiles.history.changesUntil(tiles.time);
    setText(this.text, `${share} % agree, ${changes} ${changes === 1 ? "change" : "changes"} of mind`);
    this.draw();
  }

  /** The time at a distance from the left end, in pixels. @param {number} x */
  timeAt(x) {
    const { begin, span } = this.view;
    return Math.max(0, begin + ((x - EDGE) / (this.canvas.clientWidth - 2 * EDGE)) * span);
  }

  /** @param {string} label @param {string} ground "#rrggbb" */
  colourOf(label, ground) {
    if (this.looks !== this.tiles.looks) this.colours.clear();
    this.looks = this.tiles.looks;
    let colour = this.colours.get(label);
    if (!colour) {
      const parts = [1, 3, 5].map((at) => parseInt(ground.trim().slice(at, at + 2), 16));
      this.colours.set(label, (colour = seenColour(this.tiles.look(label).rgb, parts)));
    }
    return colour;
  }

  draw() {
    const { canvas, pen, tiles } = this;
    const ratio = Math.min(devicePixelRatio || 1, 2);
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    if (!width || !height) return;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    const ink = (this.ink ??= inkOf(canvas));
    const rate = tiles.pace.speed || Math.max(1, tiles.pace.share);
    if (!tiles.pace.paused) this.lastRate = rate;
    const whole = spanOf(tiles);
    const window = WINDOW_S * this.lastRate;
    const begin = whole === null ? Math.max(0, tiles.time - window) : 0;
    const span = whole ?? Math.max(tiles.time - begin, window * 0.25);
    this.view = { begin, span };
    canvas.classList.toggle("goes", whole !== null);
    /** @param {number} time */
    const x = (time) => EDGE + ((time - begin) / span) * (width - 2 * EDGE);
    const top = height - MARKS - AXIS;
    pen.fillStyle = ink.ground;
    pen.beginPath();
    pen.roundRect(0, 0, width, height - AXIS, 6);
    pen.fill();
    this.drawBands(x, top, begin, ink);
    this.drawMarks(x, top, begin, ink);
    pen.fillStyle = ink.text;
    pen.strokeStyle = ink.line;
    pen.lineWidth = 1;
    pen.font = ink.font;
    pen.textBaseline = "bottom";
    if (tiles.time < tiles.history.known) {
      pen.fillStyle = "#fff";
      pen.fillRect(x(tiles.time) - 1, 0, 2, height - AXIS); // now, with what comes next beside it
      pen.fillStyle = ink.text;
    }
    const step = roundStep(span, Math.max(2, width / 110));
    for (let time = Math.ceil(begin / step) * step; x(time) < width - 8; time += step) {
      pen.beginPath();
      pen.moveTo(Math.round(x(time)) + 0.5, height - AXIS);
      pen.lineTo(Math.round(x(time)) + 0.5, height - AXIS + 3);
      pen.stroke();
      const text = timeText(time, step);
      const at = Math.max(0, x(time) - pen.measureText(text).width / 2);
      if (at + pen.measureText(text).width < width) pen.fillText(text, at, height);
    }
  }

  /** @param {(time: number) => number} x @param {number} height @param {number} begin @param {Ink} ink */
  drawBands(x, height, begin, ink) {
    const { pen, tiles } = this;
    const { samples } = tiles.history;
    let first = samples.length - 1;
    while (first > 0 && samples[first].time > begin) first--;
    const labels = tiles.looks.map((look) => look.label);
    for (let i = Math.max(first, 0); i < samples.length; i++) {
      const { counts, total, time } = samples[i];
      const from = Math.max(EDGE, Math.round(x(time)));
      const to = Math.round(x(i + 1 < samples.length ? samples[i + 1].time : Math.max(tiles.time, tiles.history.known)));
      if (!total || to <= from) continue;
      let y = height;
      for (const label of labels) {
        const tall = ((counts.get(label) ?? 0) / total) * height;
        if (!tall) continue;
        pen.fillStyle = this.colourOf(label, ink.ground);
        pen.fillRect(from, y - tall, to - from, tall);
        y -= tall;
      }
      if (y > 0.5) {
        pen.fillStyle = ink.band;
        pen.fillRect(from, 0, to - from, y);
      }
    }
  }

  /** @param {(time: number) => number} x @param {number} top @param {number} begin @param {Ink} ink */
  drawMarks(x, top, begin, ink) {
    const { pen, tiles } = this;
    const drawn = new Set(); // a long run has many more than pixels
    for (let i = tiles.history.changes.length - 1; i >= 0 && tiles.history.changes[i].time >= begin; i--) {
      const { time, from, to } = tiles.history.changes[i];
      const key = `${Math.round(x(time))} ${to}`;
      if (from === "" || to === "" || drawn.has(key)) continue;
      drawn.add(key);
      pen.fillStyle = this.colourOf(to, ink.ground);
      pen.beginPath();
      pen.arc(x(time), top + MARKS / 2 + 1, 2.6, 0, 7);
      pen.fill();
    }
  }
}
