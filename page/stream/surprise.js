// "Surprise me": another drawing under the running tiles, and sometimes a fault.

/** @import { Command } from "./source.js" */
/** @import { Tiles } from "./tiles.js" */
import { cellsOf, known } from "./drawing.js";
import { SIDES } from "./source.js";

/**
 * @param {Tiles} tiles
 * @param {() => number} chance 0 to less than 1
 * @returns {Command[]}
 */
export function surprise(tiles, chance) {
  /** @template T @param {T[]} list */
  const one = (list) => list[Math.floor(chance() * list.length)];
  const laid = tiles.laid();
  const places = laid.map((tile) => tile.place);
  const now = known(places, tiles.drawings);
  const others = tiles.drawings.filter((drawing) => drawing.label !== now?.label);
  const kind = chance();
  if (kind < 0.6 || laid.length < 4) {
    const drawing = one(others);
    const top = places.length ? Math.min(...places.map(([row]) => row)) : 0;
    const left = places.length ? Math.min(...places.map(([, col]) => col)) : 0;
    const cells = cellsOf(drawing?.rows ?? ["#"]).map(([row, col]) => [row + top, col + left]);
    return [{ do: "arrange", cells }];
  }
  const tile = one(laid);
  if (kind < 0.75) return [{ do: "pull", port: tile.port }];
  if (kind < 0.85) return [{ do: "power", port: tile.port, on: !tile.powered }];
  const sides = [0, 1, 2, 3].filter((side) => tiles.neighbour(tile, side));
  return sides.map((side) => ({ do: "cut", port: tile.port, side: SIDES[side], on: !tiles.isCut(tile, side) }));
}
