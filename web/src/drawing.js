// Drawings: which tiles are there, and who is whose neighbour. `#` is a tile, `.` and a blank are none.
import { TilencaError } from "./module.js";
import { EAST, NORTH, SOUTH, WEST } from "./sides.js";

/** @typedef {{ row: number, column: number }} Place */

/**
 * The tiles of a drawing, in reading order.
 * @param {string} drawing lines of it
 * @returns {Place[]}
 */
export function tilesOf(drawing) {
  const rows = drawing.split("\n");
  const wrong = /[^#. \n]/.exec(drawing);
  if (wrong !== null) {
    throw new TilencaError(`a drawing has '${wrong[0]}'; '#' is a tile, '.' or a blank is none`);
  }
  return rows.flatMap((line, row) =>
    [...line].flatMap((character, column) => (character === "#" ? [{ row, column }] : [])),
  );
}

/**
 * Each tile's neighbours N E S W, by their numbers; -1: none.
 * @param {readonly Place[]} tiles
 * @returns {number[][]}
 */
export function neighboursOf(tiles) {
  const numbers = new Map(tiles.map(({ row, column }, number) => [`${row},${column}`, number]));
  return tiles.map(({ row, column }) =>
    [
      [row - 1, column],
      [row, column + 1],
      [row + 1, column],
      [row, column - 1],
    ].map((place) => numbers.get(place.join(",")) ?? -1),
  );
}

/**
 * The cables between tiles, in the order of `tilenca.emulator.wiring`.
 * @param {readonly Place[]} tiles
 * @returns {import("./array.js").Link[]}
 */
export function linksOf(tiles) {
  return neighboursOf(tiles).flatMap((neighbours, tile) =>
    [
      { side: EAST, otherSide: WEST },
      { side: SOUTH, otherSide: NORTH },
    ].flatMap(({ side, otherSide }) =>
      neighbours[side] < 0 ? [] : [/** @type {const} */ ([tile, side, neighbours[side], otherSide])],
    ),
  );
}
