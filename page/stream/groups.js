// Tiles that hang together, and where they go when they are parted.

/** @import { LaidTile, Tile } from "./tile.js" */
/** @import { Tiles } from "./tiles.js" */
import { OFFSETS } from "./source.js";

const FARTHEST = 16; // places that a part looks for room

/** @typedef {{ports: string[], rows: number, cols: number}} Shift tiles, and by how many places they move */

/** @param {Tile} tile @param {Tiles} tiles @param {(tile: LaidTile, side: number) => boolean} isJoined @returns {LaidTile[]} */
function reached(tile, tiles, isJoined) {
  const found = new Set([/** @type {LaidTile} */ (tile)]);
  for (const one of found) {
    for (const side of OFFSETS.keys()) {
      const other = tiles.neighbour(one, side);
      if (other?.place && isJoined(one, side)) found.add(/** @type {LaidTile} */ (other));
    }
  }
  return [...found];
}

/** The tiles that hang together with one by whole cables, itself included. @param {Tiles} tiles @param {Tile} tile */
export const clusterOf = (tiles, tile) => reached(tile, tiles, (one, side) => !tiles.isCut(one, side));

/** Tiles with power that hear each other, group by group, the largest first. @param {Tiles} tiles @returns {LaidTile[][]} */
function clusters(tiles) {
  /** @type {LaidTile[][]} */
  const found = [];
  const seen = new Set();
  for (const tile of tiles.laid()) {
    if (!tile.powered || seen.has(tile)) continue;
    const group = reached(tile, tiles, (one, side) =>
      ["whole", "failing"].includes(tiles.cableAt(one, side)) && tiles.neighbour(one, side)?.powered === true);
    for (const one of group) seen.add(one);
    found.push(group);
  }
  return found.sort((one, other) => other.length - one.length);
}

/** Those of several groups where each shows the same, and not nothing; else none. @param {Tiles} tiles */
export function mindsOf(tiles) {
  const found = clusters(tiles);
  /** @param {LaidTile[]} group */
  const isOfOneMind = (group) => tiles.shown(group[0]) !== "" && new Set(group.map((tile) => tiles.shown(tile))).size === 1;
  return found.length > 1 && found.every(isOfOneMind) ? found : [];
}

/** Whether tiles can move so far: nobody lies there, and the board does not end. @param {Tiles} tiles @param {Shift} shift */
export function isFree(tiles, { ports, rows, cols }) {
  return ports.every((port) => {
    const place = tiles.byPort.get(port)?.place;
    if (!place) return false;
    const [row, col] = [place[0] + rows, place[1] + cols];
    const other = tiles.at(row, col);
    return Math.max(Math.abs(row), Math.abs(col)) <= tiles.mostPlace && (!other || ports.includes(other.port));
  });
}

/**
 * What a stroke over some cables does: where tiles hang together by these only, all parts but the largest move away,
 * so far that they touch nobody.
 * @param {Tiles} tiles
 * @param {[Tile, number][]} crossed each with the tile in the north or west, and that tile's side
 * @returns {Shift[]}
 */
export function breakApart(tiles, crossed) {
  const ends = new Set(crossed.map(([tile, side]) => `${tile.port} ${side}`));
  /** @param {Tile} tile @param {number} side */
  const isCrossed = (tile, side) => side === 1 || side === 2
    ? ends.has(`${tile.port} ${side}`)
    : ends.has(`${tiles.neighbour(tile, side)?.port} ${(side + 2) % 4}`);
  /** @type {Shift[]} */
  const shifts = [];
  const seen = new Set();
  for (const [tile] of crossed) {
    if (seen.has(tile)) continue;
    const all = reached(tile, tiles, () => true);
    /** @type {LaidTile[][]} */
    const parts = [];
    for (const one of all) {
      seen.add(one);
      if (parts.some((part) => part.includes(one))) continue;
      parts.push(reached(one, tiles, (at, side) => !tiles.isCut(at, side) && !isCrossed(at, side)));
    }
    const [stays, ...others] = parts.sort((one, other) => other.length - one.length);
    for (const part of others) shifts.push(...wayOf(tiles, part, stays));
  }
  return shifts;
}

/** The middle of some tiles along an axis. @param {LaidTile[]} tiles @param {0 | 1} axis */
const middleOf = (tiles, axis) => tiles.reduce((sum, tile) => sum + tile.place[axis], 0) / tiles.length;

/** The nearest place for a part, away from another; none where there is no room. @param {Tiles} tiles @param {LaidTile[]} part @param {LaidTile[]} from @returns {Shift[]} */
function wayOf(tiles, part, from) {
  const away = [0, 1].map((axis) => middleOf(part, /** @type {0 | 1} */ (axis)) - middleOf(from, /** @type {0 | 1} */ (axis)));
  const ways = [...OFFSETS].sort((one, other) => (other[0] - one[0]) * away[0] + (other[1] - one[1]) * away[1]);
  const ports = part.map(({ port }) => port);
  const isAlone = (/** @type {Shift} */ { rows, cols }) => part.every(({ place: [row, col] }) => OFFSETS.every(([down, right]) => {
    const other = tiles.at(row + rows + down, col + cols + right);
    return !other || ports.includes(other.port);
  }));
  for (let far = 1; far <= FARTHEST; far++) {
    for (const [down, right] of ways) {
      const shift = { ports, rows: down * far, cols: right * far };
      if (isFree(tiles, shift) && isAlone(shift)) return [shift];
    }
  }
  return [];
}
