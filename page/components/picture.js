// The board as a picture: the same look as on the page, drawn at one size.

/** @import { Lens } from "../stream/lens.js" */
/** @import { LaidTile } from "../stream/tile.js" */
/** @import { Tiles } from "../stream/tiles.js" */
import { OFFSETS, SIDES } from "../stream/source.js";
import { cssColour } from "../stream/led.js";
import { inkOn, seenThrough, shadeOf } from "../stream/lens.js";
import { drawCable } from "./cables.js";
import { LAMPS, SEGMENTS } from "./tile.js";

const TILE = 120; // pixels of a tile's place
const MARGIN = 48;
const EDGE = 0.07; // of the place, around the tile
const FOOT = 44;
const LEAST = 480;

/** @typedef {(name: string) => string} Token a colour of the style sheet */

/**
 * @param {CanvasRenderingContext2D} pen at the corner of a tile's face of 100 x 100
 * @param {import("../stream/tile.js").Tile} tile
 * @param {Token} token
 * @param {Lens | null} lens
 */
function drawTile(pen, tile, token, lens) {
  const seen = lens && seenThrough(lens, tile);
  const shade = lens && seen !== null ? shadeOf(lens, seen) : null;
  const led = cssColour(tile.rgb);
  const isDark = tile.rgb.every((part) => part === 0);
  pen.globalAlpha = tile.powered ? 1 : 0.5;
  pen.fillStyle = shade ? `rgb(${shade.join(" ")})` : token("--housing");
  pen.beginPath();
  pen.roundRect(0, 0, 100, 100, 14);
  pen.fill();
  if (!isDark && !shade) {
    const light = pen.createRadialGradient(50, 50, 0, 50, 50, 70);
    light.addColorStop(0, led.replace(")", " / 46%)"));
    light.addColorStop(0.62, led.replace(")", " / 14%)"));
    light.addColorStop(1, led.replace(")", " / 0%)"));
    pen.fillStyle = light;
    pen.fill();
  }
  pen.lineCap = "round";
  const lit = isDark ? "" : SEGMENTS.filter((_, bit) => (tile.segments >> bit) & 1).join("");
  /** @type {[string, number, string][]} */
  const layers = shade ? [[lit, 8.5, inkOn(shade)]] : [
    [SEGMENTS.join(""), 8.5, "rgb(255 255 255 / 6%)"], [lit, 17, led.replace(")", " / 26%)")], [lit, 8.5, led],
  ];
  for (const [path, width, colour] of layers) {
    pen.lineWidth = width;
    pen.strokeStyle = colour;
    pen.stroke(new Path2D(path));
  }
  LAMPS.forEach(([x, y], side) => {
    pen.fillStyle = tile.leds[side] === SIDES[side] ? "#ffd479" : "rgb(255 255 255 / 11%)";
    pen.beginPath();
    pen.arc(x, y, 2.6, 0, 7);
    pen.fill();
  });
  if (shade) {
    pen.fillStyle = inkOn(shade);
    pen.font = `650 12px ${token("--font")}`;
    pen.textAlign = "right";
    pen.fillText(String(seen), 87, 91);
  }
  pen.globalAlpha = 1;
}

/**
 * @param {CanvasRenderingContext2D} pen at the middle of a tile's place
 * @param {Tiles} tiles @param {import("../stream/tile.js").Tile} tile @param {Token} token
 */
function drawCables(pen, tiles, tile, token) {
  for (const side of [1, 2]) {
    if (!tiles.neighbour(tile, side)) continue;
    const [down, right] = OFFSETS[side];
    pen.save();
    pen.translate((right * TILE) / 2, (down * TILE) / 2);
    if (down) pen.rotate(Math.PI / 2);
    drawCable(pen, tiles.cableAt(tile, side), TILE, token);
    pen.restore();
  }
}

/** The smallest box around tiles, as rows and columns. @param {import("../stream/source.js").Place[]} places */
export function boxOf(places) {
  const [rows, cols] = [0, 1].map((axis) => places.map((place) => place[axis]));
  if (!places.length) return { top: 0, left: 0, rows: 1, cols: 1 };
  const [top, left] = [Math.min(...rows), Math.min(...cols)];
  return { top, left, rows: Math.max(...rows) - top + 1, cols: Math.max(...cols) - left + 1 };
}

/**
 * @typedef {{
 *   words: string, lens: Lens | null, box?: ReturnType<typeof boxOf>, size?: number,
 * }} Painting what stands below; what the colours tell; which part; pixels of a tile's place
 */

/**
 * Draws the tiles and cables with a line of words below.
 * @param {HTMLCanvasElement} canvas gets its size
 * @param {Tiles} tiles @param {Painting} painting
 */
export function paintBoard(canvas, tiles, { words, lens, box, size = TILE }) {
  const style = getComputedStyle(document.documentElement);
  const token = (/** @type {string} */ name) => style.getPropertyValue(name).trim();
  const laid = tiles.laid();
  const { top, left, rows, cols } = box ?? boxOf(laid.map((tile) => tile.place));
  const ratio = size / TILE;
  const width = Math.max(LEAST, cols * TILE + 2 * MARGIN);
  const height = rows * TILE + 2 * MARGIN + FOOT;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { willReadFrequently: size !== TILE }));
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.fillStyle = token("--raised");
  pen.fillRect(0, 0, width, height);
  /** Draws something at the middle of each tile's place. @param {(tile: LaidTile) => void} draw */
  const atEach = (draw) => {
    for (const tile of laid) {
      pen.save();
      pen.translate((width - cols * TILE) / 2 + (tile.place[1] - left + 0.5) * TILE, MARGIN + (tile.place[0] - top + 0.5) * TILE);
      draw(tile);
      pen.restore();
    }
  };
  atEach((tile) => {
    if (tile.turned) pen.rotate(Math.PI / 2);
    pen.translate((EDGE - 0.5) * TILE, (EDGE - 0.5) * TILE);
    pen.scale((TILE * (1 - 2 * EDGE)) / 100, (TILE * (1 - 2 * EDGE)) / 100);
    drawTile(pen, tile, token, lens);
  });
  atEach((tile) => drawCables(pen, tiles, tile, token)); // over the tiles, as on the page
  pen.fillStyle = token("--ink");
  pen.font = `600 22px ${token("--font")}`;
  pen.textAlign = "center";
  pen.fillText(words, width / 2, height - MARGIN, width - MARGIN);
}

/**
 * The same as PNG.
 * @param {Tiles} tiles @param {Painting} painting
 * @returns {Promise<Blob>}
 */
export function boardPicture(tiles, painting) {
  const canvas = document.createElement("canvas");
  paintBoard(canvas, tiles, painting);
  return new Promise((resolve, reject) => {
    canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("the browser makes no picture"))), "image/png");
  });
}
