// The cables between the tiles, and in slow motion what runs along them. Drawn on one canvas over the board.

/** @import { Pulse, Tiles } from "../stream/tiles.js" */
/** @import { View } from "./view.js" */
import { OFFSETS } from "../stream/source.js";
import { cssColour } from "../stream/led.js";
import { calm, element } from "./dom.js";

const BITS = 10; // of a byte on the cable
const COLUMN_BAUD = 38400;
const ROW_BAUD = 125000;
const SHORTEST_MS = 140;
const MOST = 240;
// From the middle of a tile to its edge, and to where a pulse begins, in tiles.
const EDGE = 0.43;
const START = 0.34;

/** The colour of a cable by its state. */
const TOKENS = { whole: "--cable", failing: "--failing", cut: "--cut", turned: "--failing" };

/**
 * Draws a cable: its wires; where it is cut, a cross over their ends; where a tile is turned, a bar before each end.
 * @param {CanvasRenderingContext2D} pen at the middle of the cable, which lies along x
 * @param {keyof typeof TOKENS} state @param {number} size pixels of a tile's place
 * @param {(name: string) => string} token a colour of the style sheet
 */
export function drawCable(pen, state, size, token) {
  const gap = size * (0.5 - EDGE);
  const isWhole = state === "whole" || state === "failing";
  pen.strokeStyle = token(TOKENS[state]);
  pen.lineWidth = Math.max(1, size * 0.022);
  pen.lineCap = "butt";
  pen.beginPath();
  for (const offset of [-1, 0, 1]) {
    const at = (offset * size * 0.2) / 3;
    pen.moveTo(-gap, at);
    pen.lineTo(isWhole ? gap : -gap * 0.45, at);
    if (isWhole) continue;
    pen.moveTo(gap * 0.45, at);
    pen.lineTo(gap, at);
  }
  pen.stroke();
  if (isWhole) return;
  // Seen from afar, with a rim that parts it from the tiles.
  const far = Math.max(6, size * 0.1);
  const [x, y] = state === "cut" ? [far, far] : [gap * 0.45, far * 1.2];
  pen.lineCap = "round";
  for (const [colour, wide] of /** @type {[string, number][]} */ ([["--raised", 0.09], [TOKENS[state], 0.045]])) {
    pen.strokeStyle = token(colour);
    pen.lineWidth = Math.max(50 * wide, size * wide);
    pen.beginPath();
    for (const way of [-1, 1]) {
      pen.moveTo(x * way, -y);
      pen.lineTo(state === "cut" ? -x * way : x * way, y);
    }
    pen.stroke();
  }
}

/** @typedef {{x: number, y: number, dx: number, dy: number, from: number, ms: number, colour: string}} Flight */

export class Cables {
  constructor() {
    // What lies still is drawn seldom, what flies with every frame.
    this.canvases = ["cables", "cables flying"].map((name) => element("canvas", { class: name, "aria-hidden": "true" }));
    const [still, air] = this.canvases.map((canvas) => canvas.getContext("2d"));
    this.still = /** @type {CanvasRenderingContext2D} */ (still);
    this.air = /** @type {CanvasRenderingContext2D} */ (air);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => (this.isStale = true));
    /** @type {Flight[]} */
    this.flights = [];
    this.isStale = true;
    this.wasFlying = false;
    /** Tiles in the hand: the cables between them come along, and their others hang loose. @type {Set<string>} */
    this.lifted = new Set();
    /** How far the hand has carried them, in pixels. */
    this.carried = [0, 0];
    /** The stroke of the knife, in pixels. @type {[number, number][]} */
    this.stroke = [];
  }

  /** @param {number} width @param {number} height */
  resize(width, height) {
    const ratio = Math.min(devicePixelRatio || 1, 2);
    for (const pen of [this.still, this.air]) {
      pen.canvas.width = Math.round(width * ratio);
      pen.canvas.height = Math.round(height * ratio);
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    }
    this.isStale = true;
  }

  /** Tiles are in the hand, or none. @param {string[]} ports @param {number} dx @param {number} dy */
  lift(ports, dx, dy) {
    this.lifted = new Set(ports);
    this.carried = [dx, dy];
    this.isStale = true;
  }

  /** Lets frames fly. @param {Pulse[]} pulses @param {Tiles} tiles @param {View} view @param {number} now */
  launch(pulses, tiles, view, now) {
    if (calm.matches || tiles.pace.speed === 0) return;
    for (const pulse of pulses) {
      const tile = tiles.byPort.get(pulse.from);
      if (!tile?.place || this.lifted.size || this.flights.length >= MOST || ["cut", "turned"].includes(tiles.cableAt(tile, pulse.side))) continue;
      const [x, y] = view.middle(...tile.place);
      const [down, right] = OFFSETS[pulse.side];
      const baud = down ? COLUMN_BAUD : ROW_BAUD;
      const ms = Math.max(SHORTEST_MS, (1000 * pulse.bytes * BITS) / baud / tiles.pace.speed);
      this.flights.push({ x, y, dx: right, dy: down, from: now, ms, colour: cssColour(tile.rgb) });
    }
  }

  /** @param {Tiles} tiles @param {View} view @param {number} now */
  draw(tiles, view, now) {
    this.flights = this.flights.filter((flight) => now - flight.from < flight.ms);
    if (this.isStale) {
      this.still.clearRect(0, 0, this.still.canvas.width, this.still.canvas.height);
      this.drawCables(tiles, view);
    }
    const isFlying = this.flights.length > 0 || this.stroke.length > 1;
    if (isFlying || this.wasFlying || this.isStale) this.drawFlights(view, now);
    this.wasFlying = isFlying;
    this.isStale = false;
  }

  /** @param {View} view @param {number} now */
  drawFlights(view, now) {
    const pen = this.air;
    pen.clearRect(0, 0, pen.canvas.width, pen.canvas.height);
    const length = view.size * (1 - 2 * START);
    for (const { x, y, dx, dy, from, ms, colour } of this.flights) {
      const way = view.size * START + (length * (now - from)) / ms;
      pen.fillStyle = colour;
      pen.globalAlpha = 0.95;
      pen.beginPath();
      // To the right of its way, so that both directions are seen.
      const aside = view.size * 0.055;
      pen.arc(x + dx * way - dy * aside, y + dy * way + dx * aside, Math.max(1.6, view.size * 0.028), 0, 7);
      pen.fill();
    }
    pen.globalAlpha = 1;
    this.drawStroke();
  }

  /** @param {Tiles} tiles @param {View} view */
  drawCables(tiles, view) {
    const pen = this.still;
    const style = getComputedStyle(pen.canvas);
    for (const tile of tiles.laid()) {
      for (const side of [1, 2]) {
        const other = tiles.neighbour(tile, side);
        if (!other || this.lifted.has(tile.port) !== this.lifted.has(other.port)) continue;
        const [dx, dy] = this.lifted.has(tile.port) ? this.carried : [0, 0];
        const [x, y] = view.middle(...tile.place).map((at, axis) => at + [dx, dy][axis]);
        const [down, right] = OFFSETS[side];
        pen.save();
        pen.translate(x + (right * view.size) / 2, y + (down * view.size) / 2);
        if (down) pen.rotate(Math.PI / 2);
        drawCable(pen, tiles.cableAt(tile, side), view.size, (name) => style.getPropertyValue(name));
        pen.restore();
      }
    }
  }

  drawStroke() {
    if (this.stroke.length < 2) return;
    const pen = this.air;
    pen.strokeStyle = getComputedStyle(pen.canvas).getPropertyValue("--cut");
    pen.lineWidth = 2;
    pen.lineCap = pen.lineJoin = "round";
    pen.beginPath();
    this.stroke.forEach(([x, y], index) => (index ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    pen.stroke();
  }
}
