// The part of the board that is in view: places to pixels and back.

/** @import { Place } from "../stream/source.js" */

// Around the tiles: room to put one, which is seen whole.
const MARGIN = 1;
const HAIR = 0.02;
export const MARGIN_PX = 36; // and for a line of text
// Where tiles are dropped to be taken out: beside the places, where words have room, else below them.
const OUTLET = { narrowest: 108, widest: 220, lowest: 44, highest: 72, gap: 8 };
const LARGEST = 132;
const SMALLEST = 26;
// In view where no tile lies: room for a digit.
const [EMPTY_ROWS, EMPTY_COLS] = [5, 4];

export class View {
  constructor() {
    this.top = 0;
    this.left = 0;
    this.size = 64;
    this.x = 0;
    this.y = 0;
    this.rows = 1;
    this.cols = 1;
    this.width = 0;
    this.height = 0;
    /** Whether all places that the box has room for are in reach, not only those beside the tiles. */
    this.isWide = false;
  }

  /**
   * Fits places into a box of pixels; the bounding box counts as at least 3 x 3.
   * @param {Place[]} places @param {number} width @param {number} height
   */
  fit(places, width, height) {
    this.width = width;
    this.height = height;
    const rows = places.map(([row]) => row);
    const cols = places.map(([, col]) => col);
    this.top = places.length ? Math.min(...rows) : 0;
    this.left = places.length ? Math.min(...cols) : 0;
    this.rows = places.length ? Math.max(...rows) - this.top + 1 : EMPTY_ROWS;
    this.cols = places.length ? Math.max(...cols) - this.left + 1 : EMPTY_COLS;
    const fitting = Math.min(
      width / (Math.max(this.cols, 3) + 2 * MARGIN), height / (Math.max(this.rows, 3) + 2 * MARGIN),
      (height - 2 * MARGIN_PX) / Math.max(this.rows, 3),
    );
    this.size = Math.floor(Math.max(SMALLEST, Math.min(LARGEST, fitting)));
    this.x = Math.round((width - this.cols * this.size) / 2);
    this.y = Math.round((height - this.rows * this.size) / 2);
  }

  /** Whether places are in reach, and the box is as it was. @param {Place[]} places @param {number} width @param {number} height */
  shows(places, width, height) {
    return width === this.width && height === this.height && places.every((place) => this.isInReach(place));
  }

  /** Opposite corners of the places in reach: the tiles' box and one more all around, or as many as there is room for. @returns {[Place, Place]} */
  reach() {
    /** @param {number} start @param {number} end */
    const room = (start, end) => [start, end].map((one) => (this.isWide ? Math.max(1, Math.floor(one / this.size + HAIR)) : 1));
    const [above, below] = room(this.y, this.height - this.y - this.rows * this.size);
    const [before, after] = room(this.x, this.width - this.x - this.cols * this.size);
    return [[this.top - above, this.left - before], [this.top + this.rows - 1 + below, this.left + this.cols - 1 + after]];
  }

  /** The box of pixels where a tile is dropped to be taken out, in the board. */
  outlet() {
    const { narrowest, widest, lowest, highest, gap } = OUTLET;
    const beside = this.width - this.x - (this.cols + 1) * this.size - 2 * gap;
    const below = this.height - this.y - (this.rows + 1) * this.size - 2 * gap;
    if (beside >= narrowest) {
      const width = Math.min(beside, widest);
      return { left: this.width - gap - width, top: gap, width, height: this.height - 2 * gap };
    }
    const height = Math.min(Math.max(below, lowest), highest);
    return { left: gap, top: this.height - gap - height, width: this.width - 2 * gap, height };
  }

  /** Where a tile would be dropped at a point: at a place, out of the board, or nowhere, null. @param {[number, number]} at @returns {Place | "out" | null} */
  target([x, y]) {
    const { left, top, width, height } = this.outlet();
    if (x < 0 || y < 0 || x >= this.width || y >= this.height) return "out";
    if (x >= left && x < left + width && y >= top && y < top + height) return "out";
    const place = this.placeAt(x, y);
    return this.isInReach(place) ? place : null;
  }

  /** @param {Place} place */
  isInReach([row, col]) {
    const [[top, left], [bottom, right]] = this.reach();
    return row >= top && row <= bottom && col >= left && col <= right;
  }

  /** Opposite corners of what was fitted last. @returns {Place[]} */
  ends() {
    return [[this.top, this.left], [this.top + this.rows - 1, this.left + this.cols - 1]];
  }

  /** The upper left corner of a place. @param {number} row @param {number} col @returns {[number, number]} */
  corner(row, col) {
    return [this.x + (col - this.left) * this.size, this.y + (row - this.top) * this.size];
  }

  /** @param {number} row @param {number} col @returns {[number, number]} */
  middle(row, col) {
    const [x, y] = this.corner(row, col);
    return [x + this.size / 2, y + this.size / 2];
  }

  /** The place at a point. @param {number} x @param {number} y @returns {Place} */
  placeAt(x, y) {
    return [Math.floor((y - this.y) / this.size) + this.top, Math.floor((x - this.x) / this.size) + this.left];
  }

  /**
   * How far places in the hand are shown to be carried: never out of the window.
   * @param {Place[]} places @param {[number, number]} by in pixels @param {{left: number, top: number}} board in the window
   * @returns {[number, number]}
   */
  inWindow(places, [dx, dy], { left, top }) {
    const corners = places.map((place) => this.corner(...place));
    /** @param {number} way @param {0 | 1} axis @param {number} start of the board @param {number} end of the window */
    const kept = (way, axis, start, end) => {
      const at = corners.map((corner) => corner[axis] + start);
      return Math.max(Math.min(0, -Math.min(...at)), Math.min(Math.max(0, end - this.size - Math.max(...at)), way));
    };
    const { clientWidth, clientHeight } = document.documentElement;
    return [kept(dx, 0, left, clientWidth), kept(dy, 1, top, clientHeight)];
  }

  /** Empty and other places in reach. @returns {Place[]} */
  places() {
    /** @type {Place[]} */
    const all = [];
    const [[top, left], [bottom, right]] = this.reach();
    for (let row = top; row <= bottom; row++) {
      for (let col = left; col <= right; col++) all.push([row, col]);
    }
    return all;
  }
}
