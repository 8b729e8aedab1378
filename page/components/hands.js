// What a pointer does on the board: pick up tiles, draw, cut, break apart. Knows places, and no elements of tiles.

/** @import { Place } from "../stream/source.js" */
/** @import { Tile } from "../stream/tile.js" */
/** @import { Tiles } from "../stream/tiles.js" */
/** @import { View } from "./view.js" */
import { breakApart, clusterOf, isFree } from "../stream/groups.js";
import { OFFSETS, SIDES } from "../stream/source.js";

/** @typedef {"hand" | "group" | "pencil" | "knife"} Tool */

// A pointer that moved less has clicked.
const CLICK_PX = 6;

/** Whether two stretches cross. @param {number[]} a @param {number[]} b @param {number[]} c @param {number[]} d */
function cross(a, b, c, d) {
  /** @param {number[]} p @param {number[]} q @param {number[]} r */
  const turn = (p, q, r) => Math.sign((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]));
  return turn(a, b, c) !== turn(a, b, d) && turn(c, d, a) !== turn(c, d, b);
}

/**
 * The cables that a stroke crosses: each with its tile in the north or west, and that tile's side.
 * @param {[number, number]} from @param {[number, number]} to @param {Tiles} tiles @param {View} view
 * @returns {[Tile, number][]}
 */
export function cablesCrossed(from, to, tiles, view) {
  /** @type {[Tile, number][]} */
  const found = [];
  for (const tile of tiles.laid()) {
    const middle = view.middle(...tile.place);
    for (const side of [1, 2]) {
      const other = tiles.neighbour(tile, side);
      if (other?.place && cross(from, to, middle, view.middle(...other.place))) found.push([tile, side]);
    }
  }
  return found;
}

/**
 * The cable nearest to a point, if it is near: for a click of the knife.
 * @param {[number, number]} at @param {Tiles} tiles @param {View} view
 * @returns {[Tile, number] | null}
 */
function cableNear(at, tiles, view) {
  for (const tile of tiles.laid()) {
    const [x, y] = view.middle(...tile.place);
    for (const side of [1, 2]) {
      const [down, right] = OFFSETS[side];
      const far = Math.hypot(at[0] - x - (right * view.size) / 2, at[1] - y - (down * view.size) / 2);
      if (tiles.neighbour(tile, side) && far < view.size * 0.25) return [tile, side];
    }
  }
  return null;
}

/**
 * @typedef {{
 *   select: (port: string | null) => void,
 *   put: (place: Place) => void,
 *   pull: (port: string) => void,
 *   move: (port: string, place: Place) => void,
 *   shift: (shift: import("../stream/groups.js").Shift) => void,
 *   cut: (port: string, side: string, on: boolean) => void,
 *   lift: (ports: string[], dx: number, dy: number, target: Place | "out" | null) => void,
 *   drop: () => void,
 *   stroke: (points: [number, number][]) => void,
 * }} Deeds
 */

export class Hands {
  /** @param {HTMLElement} board @param {Tiles} tiles @param {View} view @param {Deeds} deeds */
  constructor(board, tiles, view, deeds) {
    this.board = board;
    this.tiles = tiles;
    this.view = view;
    this.deeds = deeds;
    /** @type {Tool} */
    this.tool = "hand";
    /** @type {{id: number, start: [number, number], last: [number, number], tile: Tile | undefined,
     *   group: string[] | null, crossed: [Tile, number][], moved: boolean, puts: boolean | null, drawn: Set<string>, points: [number, number][]} | null} */
    this.grip = null;
    board.addEventListener("pointerdown", (event) => this.down(event));
    board.addEventListener("pointermove", (event) => this.moved(event));
    board.addEventListener("pointerup", (event) => this.up(event));
    board.addEventListener("pointercancel", () => this.letGo());
    // A tap opens details, which may lie under the finger: no click is to follow that would meet their buttons.
    board.addEventListener("touchend", (event) => event.cancelable && event.preventDefault());
  }

  /** @param {PointerEvent} event @returns {[number, number]} */
  point(event) {
    const box = this.board.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  /** @param {PointerEvent} event */
  down(event) {
    if (event.button !== 0 || this.grip) return;
    const at = this.point(event);
    const place = this.view.placeAt(...at);
    const tile = this.tiles.at(...place);
    const isGroup = this.tool === "group" || (this.tool === "hand" && event.shiftKey);
    const group = isGroup && tile ? clusterOf(this.tiles, tile).map(({ port }) => port) : null;
    this.grip = {
      id: event.pointerId, start: at, last: at, tile, group, crossed: [], moved: false,
      puts: tile ? null : true, drawn: new Set(), points: [at],
    };
    this.board.setPointerCapture(event.pointerId);
    if (this.tool === "pencil" && !tile) this.draw(place);
  }

  /** @param {PointerEvent} event */
  moved(event) {
    const { grip } = this;
    if (!grip || event.pointerId !== grip.id) return;
    const at = this.point(event);
    if (Math.hypot(at[0] - grip.start[0], at[1] - grip.start[1]) > CLICK_PX) grip.moved = true;
    if (this.tool === "pencil") {
      for (const place of this.placesBetween(grip.last, at)) {
        if (grip.puts === null) this.decide(place);
        if (grip.puts !== null) this.draw(place);
      }
    } else if (this.tool === "knife" && grip.moved) {
      for (const [tile, side] of cablesCrossed(grip.last, at, this.tiles, this.view)) {
        if (!this.tiles.isCut(tile, side)) this.deeds.cut(tile.port, SIDES[side], true);
      }
      this.stroke(at);
    } else if (this.tool === "group" && !grip.tile && grip.moved) {
      grip.crossed.push(...cablesCrossed(grip.last, at, this.tiles, this.view));
      this.stroke(at);
    } else if (this.holds("move", "shift") && grip.tile && grip.moved) {
      this.deeds.lift(grip.group ?? [grip.tile.port], at[0] - grip.start[0], at[1] - grip.start[1], this.view.target(at));
    }
    grip.last = at;
  }

  /** @param {PointerEvent} event */
  up(event) {
    const { grip } = this;
    if (!grip || event.pointerId !== grip.id) return;
    const at = this.point(event);
    if (this.tool === "hand" || this.tool === "group") {
      if (!grip.moved) {
        if (grip.tile) this.deeds.select(grip.tile.port);
        else if (this.tool === "hand" && this.tiles.can("put")) this.deeds.put(this.view.placeAt(...at));
      } else if (grip.tile && this.holds("move", "shift")) {
        this.letGoAt(this.view.target(at));
      } else {
        for (const shift of breakApart(this.tiles, grip.crossed)) this.deeds.shift(shift);
      }
    } else if (this.tool === "pencil" && grip.puts === null) {
      grip.puts = false; // it has stayed on one tile
      this.draw(this.view.placeAt(...grip.start));
    } else if (this.tool === "knife" && !grip.moved) {
      const near = cableNear(at, this.tiles, this.view);
      if (near) this.deeds.cut(near[0].port, SIDES[near[1]], !this.tiles.isCut(...near));
    }
    this.letGo();
  }

  /** Whether what is held can be carried. @param {string} one command for a tile @param {string} group for several */
  holds(one, group) {
    return (this.tool === "hand" || this.tool === "group") && this.tiles.can(this.grip?.group ? group : one);
  }

  /** What is held lands; nowhere, it goes back. @param {Place | "out" | null} place of the tile under the pointer */
  letGoAt(place) {
    const { tile, group } = this.grip ?? {};
    if (!tile?.place || !place) return;
    if (place === "out") {
      for (const port of group ?? [tile.port]) this.deeds.pull(port);
    } else if (!group) {
      if (!this.tiles.at(...place)) this.deeds.move(tile.port, place);
    } else {
      const shift = { ports: group, rows: place[0] - tile.place[0], cols: place[1] - tile.place[1] };
      if ((shift.rows || shift.cols) && isFree(this.tiles, shift)) this.deeds.shift(shift);
    }
  }

  /** @param {[number, number]} at */
  stroke(at) {
    if (!this.grip) return;
    this.grip.points.push(at);
    this.deeds.stroke(this.grip.points.slice(-40));
  }

  letGo() {
    this.grip = null;
    this.deeds.stroke([]);
    this.deeds.drop();
  }

  /** A stroke that began on a tile comes to another place: over tiles it rubs them out, else it draws on from there. @param {Place} place */
  decide(place) {
    const { grip } = this;
    if (!grip) return;
    const first = this.view.placeAt(...grip.start);
    if (place.join() === first.join()) return;
    grip.puts = !this.tiles.at(...place);
    if (!grip.puts) this.draw(first);
  }

  /** @param {Place} place */
  draw(place) {
    const { grip } = this;
    if (!grip || grip.drawn.has(place.join())) return;
    grip.drawn.add(place.join());
    const tile = this.tiles.at(...place);
    if (grip.puts && !tile && this.view.isInReach(place)) this.deeds.put(place);
    else if (!grip.puts && tile) this.deeds.pull(tile.port);
  }

  /** The places on the way: a quick pointer jumps. @param {[number, number]} from @param {[number, number]} to */
  placesBetween(from, to) {
    const steps = Math.max(1, Math.ceil(Math.hypot(to[0] - from[0], to[1] - from[1]) / (this.view.size / 3)));
    /** @type {Place[]} */
    const places = [];
    for (let step = 1; step <= steps; step++) {
      const share = step / steps;
      const place = this.view.placeAt(from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share);
      const last = places.at(-1);
      if (!last || last[0] !== place[0] || last[1] !== place[1]) places.push(place);
    }
    return places;
  }
}
