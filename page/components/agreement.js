// Agreement over time: what share of the tiles showed what, and a mark for every change of mind and for every deed.

/** @import { Look } from "../stream/source.js" */
/** @import { Tiles } from "../stream/tiles.js" */
import { deedMoments } from "../stream/deeds.js";
import { mindsOf } from "../stream/groups.js";
import { seenColour } from "../stream/led.js";
import { byId, element, setText } from "./dom.js";

// What is in view of tiles whose time does not go back, in seconds of the wall clock.
const WINDOW_S = 24;
const LEAST_S = 1; // of a run in view
// What can be in view of a long run, in seconds; 0: the whole run.
const WINDOWS_S = [10, 2, 0];
const EDGE = 8; // pixels left and right: half the thumb of the slider below, which has the same scale
const STEPS = [1, 2, 5];
const MARKS = 13; // pixels for the marks below the bands
const AXIS = 17;
const STRIP = 12; // pixels for the whole run, below a part of it
const LEAST_FRAME = 8; // pixels around the part, of a very long run
const DRAW_MS = 90;
const DEED = 5; // pixels of half the mark of a deed; a pointer is at it within as many

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

/** The time at the right end of the slider below the chart, which begins at 0; null: time does not go back here. @param {Pick<Tiles, "end">} tiles */
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
    /** The time at the left end, and from there to the right end. */
    this.view = { begin: 0, span: 1 };
    /** The whole run, where the chart has only a part of it. @type {number | null} */
    this.whole = null;
    this.window = WINDOWS_S[0];
    /** How each label is seen on the ground. @type {Map<string, string>} */
    this.colours = new Map();
    /** @type {Look[] | null} */
    this.looks = null;
    this.choice = element("select", {
      "aria-label": "Time in view", title: "How much of the run the chart shows", hidden: true,
      onchange: () => {
        this.window = Number(this.choice.value);
        this.drawn = 0;
        this.update(performance.now());
      },
    }, ...WINDOWS_S.map((seconds) => element("option", { value: seconds }, seconds ? `${seconds} s` : "Whole run")));
    byId("agreement-text").after(this.choice);
    this.canvas.addEventListener("click", (event) => {
      if (tiles.end !== null) go(Math.min(this.timeAt(event.offsetX, event.offsetY), tiles.end));
    });
    this.canvas.addEventListener("pointermove", ({ offsetX, offsetY }) => (this.canvas.title = this.deedAt(offsetX, offsetY)));
    this.lastRate = 1;
    /** The timer of what was too soon to be drawn. */
    this.later = 0;
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
    this.tell();
    if (now - this.drawn < DRAW_MS) {
      this.later ||= setTimeout(() => this.update(performance.now()), DRAW_MS); // nothing may follow
      return;
    }
    clearTimeout(this.later);
    this.later = 0;
    this.drawn = now;
    this.draw();
  }

  /** Says it of the same moment as the verdict and the clock. */
  tell() {
    const { tiles } = this;
    const { counts, total } = tiles.count();
    const most = Math.max(0, ...[...counts].filter(([label]) => label).map(([, count]) => count));
    const share = total ? Math.round((100 * most) / total) : 0;
    const changes = tiles.history.changesUntil(tiles.time);
    const groups = share < 100 ? mindsOf(tiles).length : 0;
    const agree = groups ? `Each of ${groups} groups agrees` : `${share} % agree`;
    const deeds = deedMoments(tiles.deeds).filter(({ time }) => time <= tiles.time).length;
    const done = deeds ? `, ${deeds} ${deeds === 1 ? "deed" : "deeds"}` : "";
    setText(this.text, `${agree}, ${changes} ${changes === 1 ? "change" : "changes"} of mind${done}`);
  }

  /** The time at a point of the chart, in pixels. @param {number} x @param {number} y */
  timeAt(x, y) {
    const isInStrip = this.whole !== null && y >= this.canvas.clientHeight - STRIP;
    const { begin, span } = isInStrip ? { begin: 0, span: this.whole ?? 1 } : this.view;
    return Math.max(0, begin + ((x - EDGE) / (this.canvas.clientWidth - 2 * EDGE)) * span);
  }

  /** What hands did at a point of the chart; "" for nothing. @param {number} x @param {number} y */
  deedAt(x, y) {
    const isInStrip = this.whole !== null && y >= this.canvas.clientHeight - STRIP;
    const at = isInStrip ? this.scale(0, this.whole ?? 1) : this.scale(this.view.begin, this.view.span);
    const near = deedMoments(this.tiles.deeds).filter(({ time }) => Math.abs(at(time) - x) <= DEED);
    return near.map(({ time, words }) => `${time.toFixed(2)} s: ${words}`).join("\n");
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
    this.view = this.inView();
    const { begin, span } = this.view;
    canvas.classList.toggle("goes", tiles.end !== null);
    const x = this.scale(begin, span);
    const bottom = height - (this.whole === null ? 0 : STRIP);
    const top = bottom - MARKS - AXIS;
    pen.fillStyle = ink.ground;
    pen.beginPath();
    pen.roundRect(0, 0, width, bottom - AXIS, 6);
    pen.fill();
    this.drawBands(x, 0, top, ink);
    this.drawMarks(x, top, ink);
    this.drawDeeds(x, 0);
    this.drawNow(x, 0, bottom - AXIS);
    this.drawAxis(x, bottom, ink);
    if (this.whole !== null) this.drawStrip(this.whole, bottom + 2, ink);
  }

  /** What is in view. A part of a long run stays where it is, until time leaves it. */
  inView() {
    const { tiles } = this;
    const end = spanOf(tiles);
    this.choice.hidden = end === null || end <= Math.min(...WINDOWS_S.filter(Boolean));
    const isPart = end !== null && this.window > 0 && end > this.window;
    this.whole = isPart ? end : null;
    if (end !== null && !isPart) return { begin: 0, span: end };
    if (end !== null) {
      const { time } = tiles;
      const held = Math.min(this.view.begin, end - this.window);
      const begin = time < held ? Math.max(0, time - this.window / 4) : Math.max(held, time - this.window);
      return { begin, span: this.window };
    }
    const rate = tiles.pace.speed || Math.max(1, tiles.pace.share);
    if (!tiles.pace.paused) this.lastRate = rate;
    const window = WINDOW_S * this.lastRate;
    const begin = Math.max(0, tiles.time - window);
    return { begin, span: Math.max(tiles.time - begin, window * 0.25) };
  }

  /** From times to pixels. @param {number} begin @param {number} span */
  scale(begin, span) {
    const width = this.canvas.clientWidth - 2 * EDGE;
    return (/** @type {number} */ time) => EDGE + ((time - begin) / span) * width;
  }

  /** A line at the present, where it has a future beside it. @param {(time: number) => number} x @param {number} from @param {number} to */
  drawNow(x, from, to) {
    const { pen, tiles } = this;
    if (tiles.time >= tiles.history.known) return;
    pen.fillStyle = "#fff";
    pen.fillRect(x(tiles.time) - 1, from, 2, to - from);
  }

  /** @param {(time: number) => number} x @param {number} bottom @param {Ink} ink */
  drawAxis(x, bottom, ink) {
    const { pen } = this;
    const { begin, span } = this.view;
    const width = this.canvas.clientWidth;
    pen.fillStyle = ink.text;
    pen.strokeStyle = ink.line;
    pen.lineWidth = 1;
    pen.font = ink.font;
    pen.textBaseline = "bottom";
    const step = roundStep(span, Math.max(2, width / 110));
    for (let time = Math.ceil(begin / step) * step; x(time) < width - 8; time += step) {
      pen.beginPath();
      pen.moveTo(Math.round(x(time)) + 0.5, bottom - AXIS);
      pen.lineTo(Math.round(x(time)) + 0.5, bottom - AXIS + 3);
      pen.stroke();
      const text = timeText(time, step);
      const at = Math.max(0, x(time) - pen.measureText(text).width / 2);
      if (at + pen.measureText(text).width < width) pen.fillText(text, at, bottom);
    }
  }

  /** The whole run in small, of the same scale as the slider below it, with a frame around what is above. @param {number} whole @param {number} top @param {Ink} ink */
  drawStrip(whole, top, ink) {
    const { pen } = this;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const x = this.scale(0, whole);
    pen.fillStyle = ink.ground;
    pen.beginPath();
    pen.roundRect(0, top, width, height - top, 3);
    pen.fill();
    this.drawBands(x, top, height, ink);
    const { begin, span } = this.view;
    const [left, right] = [Math.min(x(begin), width - EDGE - LEAST_FRAME), Math.max(x(begin + span), x(begin) + LEAST_FRAME)];
    pen.globalAlpha = 0.6;
    pen.fillStyle = ink.ground;
    pen.fillRect(EDGE, top, left - EDGE, height - top);
    pen.fillRect(right, top, width - EDGE - right, height - top);
    pen.globalAlpha = 1;
    this.drawDeeds(x, top);
    this.drawNow(x, top, height);
    pen.strokeStyle = "#fff";
    pen.lineWidth = 2;
    pen.strokeRect(left + 1, top + 1, right - left - 2, height - top - 2);
  }

  /** @param {(time: number) => number} x @param {number} top @param {number} bottom @param {Ink} ink */
  drawBands(x, top, bottom, ink) {
    const { pen, tiles } = this;
    const { samples } = tiles.history;
    const right = this.canvas.clientWidth - EDGE;
    const height = bottom - top;
    let first = samples.length - 1;
    while (first > 0 && x(samples[first].time) > EDGE) first--;
    const labels = tiles.looks.map((look) => look.label);
    for (let i = Math.max(first, 0); i < samples.length; i++) {
      const { counts, total, time } = samples[i];
      const from = Math.max(EDGE, Math.round(x(time)));
      const to = Math.min(right, Math.round(x(i + 1 < samples.length ? samples[i + 1].time : Math.max(tiles.time, tiles.history.known))));
      if (!total || to <= from) continue;
      let y = bottom;
      for (const label of labels) {
        const tall = ((counts.get(label) ?? 0) / total) * height;
        if (!tall) continue;
        pen.fillStyle = this.colourOf(label, ink.ground);
        pen.fillRect(from, y - tall, to - from, tall);
        y -= tall;
      }
      if (y > top + 0.5) {
        pen.fillStyle = ink.band;
        pen.fillRect(from, top, to - from, y - top);
      }
    }
  }

  /** Where hands did something. @param {(time: number) => number} x @param {number} top */
  drawDeeds(x, top) {
    const { pen } = this;
    const right = this.canvas.clientWidth - EDGE;
    pen.fillStyle = "#fff";
    pen.strokeStyle = "#000";
    pen.lineWidth = 1;
    for (const { time } of deedMoments(this.tiles.deeds)) {
      const at = x(time);
      if (at < EDGE || at > right) continue;
      pen.beginPath();
      pen.moveTo(at - DEED, top + 0.5);
      pen.lineTo(at + DEED, top + 0.5);
      pen.lineTo(at, top + 1.6 * DEED);
      pen.closePath();
      pen.fill();
      pen.stroke();
    }
  }

  /** @param {(time: number) => number} x @param {number} top @param {Ink} ink */
  drawMarks(x, top, ink) {
    const { pen, tiles } = this;
    const { begin, span } = this.view;
    const drawn = new Set(); // a long run has many more than pixels
    for (let i = tiles.history.changes.length - 1; i >= 0 && tiles.history.changes[i].time >= begin; i--) {
      const { time, from, to } = tiles.history.changes[i];
      const key = `${Math.round(x(time))} ${to}`;
      if (time > begin + span || from === "" || to === "" || drawn.has(key)) continue;
      drawn.add(key);
      pen.fillStyle = this.colourOf(to, ink.ground);
      pen.beginPath();
      pen.arc(x(time), top + MARKS / 2 + 1, 2.6, 0, 7);
      pen.fill();
    }
  }
}
