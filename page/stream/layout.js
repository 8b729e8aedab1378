// The places of tiles, computed from their neighbours; twin of host/tilenca/fleet/layout.py. Pure.

/** @import { Place } from "./source.js" */
import { OFFSETS, SIDES } from "./source.js";

/** Per tile, per side: the neighbour's id and its side that faces the tile. @typedef {Map<number, Map<string, [number, string]>>} Neighbours */

/** @param {string} side */
const facing = (side) => SIDES[(SIDES.indexOf(side) + 2) % 4];

/**
 * Lays out tiles, including those that only their neighbours tell of. Each group lies beside the one before, with
 * an empty column between them.
 * @param {Neighbours} neighbours
 * @returns {{cells: Map<number, Place>, conflicts: number}} conflicts: how often tiles contradict each other
 */
export function arrange(neighbours) {
  /** @type {Map<number, Place>[]} */
  const groups = [];
  let conflicts = 0;
  let waiting = [...neighbours.keys()].sort((one, other) => one - other);
  while (waiting.length) {
    const { group, contradicted } = grow(waiting[0], neighbours);
    conflicts += contradicted;
    waiting = waiting.filter((tile) => !group.has(tile));
    groups.push(group);
  }
  groups.sort((one, other) => other.size - one.size || Math.min(...one.keys()) - Math.min(...other.keys()));
  /** @type {Map<number, Place>} */
  const cells = new Map();
  let left = 0;
  for (const group of groups) {
    const places = [...group.values()];
    const top = Math.min(...places.map(([row]) => row));
    const west = Math.min(...places.map(([, col]) => col));
    for (const [tile, [row, col]] of group) cells.set(tile, [row - top, col - west + left]);
    left += Math.max(...places.map(([, col]) => col)) - west + 2;
  }
  return { cells, conflicts };
}

/** All tiles that can be reached from one, around (0, 0). @param {number} first @param {Neighbours} neighbours */
function grow(first, neighbours) {
  /** @type {Map<number, Place>} */
  const group = new Map([[first, [0, 0]]]);
  const taken = new Map([["0,0", first]]);
  const edge = [first];
  let contradicted = 0;
  for (let tile = edge.shift(); tile !== undefined; tile = edge.shift()) {
    const [row, col] = group.get(tile) ?? [0, 0];
    const { joined, wrong } = joinedTo(tile, neighbours);
    contradicted += wrong;
    for (const [side, other] of joined) {
      const [down, right] = OFFSETS[SIDES.indexOf(side)];
      /** @type {Place} */
      const cell = [row + down, col + right];
      const known = group.get(other);
      if (known ? known.join() !== cell.join() : taken.has(cell.join())) {
        contradicted++;
      } else if (!known) {
        group.set(other, cell);
        taken.set(cell.join(), other);
        edge.push(other);
      }
    }
  }
  return { group, contradicted };
}

/** A tile's neighbours: those it hears, and those that hear it. @param {number} tile @param {Neighbours} neighbours */
function joinedTo(tile, neighbours) {
  /** @type {[string, number][]} */
  const joined = [];
  let wrong = 0;
  for (const [side, [other, theirs]] of neighbours.get(tile) ?? []) {
    if (theirs === facing(side)) joined.push([side, other]);
    else wrong++;
  }
  for (const [other, about] of neighbours) {
    for (const [side, [heard, theirs]] of about) {
      if (heard !== tile || theirs !== facing(side)) continue;
      if (!joined.some(([one, known]) => one === theirs && known === other)) joined.push([theirs, other]);
    }
  }
  return { joined, wrong };
}
