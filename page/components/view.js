// The part of the board that is in view: places to pixels and back.

/** @import { Place } from "../stream/source.js" */

// Around the tiles: room to put one.
const MARGIN = 0.62;
const MARGIN_PX = 36; // and for a line of text
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
  }

  /**
   * Fits places into a box of pixels; the bounding box counts as at least 3 x 3.
   * @param {Place[]} places @param {number} width @param {number} height
   */
  fit(places, width, height) {
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

  /** Empty and other places in view: the tiles' box and one more all around. @returns {Place[]} */
  places() {
    /** @type {Place[]} */
    const all = [];
    for (let row = this.top - 1; row <= this.top + this.rows; row++) {
      for (let col = this.left - 1; col <= this.left + this.cols; col++) all.push([row, col]);
    }
    return all;
  }
}
