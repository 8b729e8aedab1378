// Drawings as places of tiles, and as rows of text.

/** @import { Drawing, Place } from "./source.js" */

/** Places of the tiles of a drawing, whose rows have `#` or `1` for a tile. @param {string[]} rows */
export function cellsOf(rows) {
  /** @type {Place[]} */
  const cells = [];
  rows.forEach((row, r) => [...row].forEach((mark, c) => {
    if (mark === "#" || mark === "1") cells.push([r, c]);
  }));
  return cells;
}

/** The drawing of some places, cropped, in rows of 1 and 0. @param {Place[]} cells */
export function rowsOf(cells) {
  const top = Math.min(...cells.map(([row]) => row));
  const left = Math.min(...cells.map(([, col]) => col));
  const height = Math.max(...cells.map(([row]) => row)) - top + 1;
  const width = Math.max(...cells.map(([, col]) => col)) - left + 1;
  const rows = Array.from({ length: height }, () => Array(width).fill("0"));
  for (const [row, col] of cells) rows[row - top][col - left] = "1";
  return rows.map((row) => row.join(""));
}

/**
 * The last place without which a drawing is another one, with another label; none where there is none.
 * @param {Place[]} cells @param {Drawing[]} drawings
 */
export function telling(cells, drawings) {
  if (cells.length < 2) return undefined;
  const labels = new Map(drawings.map(({ rows, label }) => [rowsOf(cellsOf(rows)).join(), label]));
  const label = labels.get(rowsOf(cells).join());
  if (label === undefined) return undefined;
  return cells.findLast((_, at) => {
    const other = labels.get(rowsOf(cells.filter((_one, index) => index !== at)).join());
    return other !== undefined && other !== label;
  });
}

/** The offered drawing with these places. @param {Place[]} cells @param {Drawing[]} drawings */
export function known(cells, drawings) {
  if (!cells.length) return undefined;
  const rows = rowsOf(cells).join();
  return drawings.find((drawing) => rowsOf(cellsOf(drawing.rows)).join() === rows);
}
