// The address of the page: what a run begins with, so that a reload or a shared link gives the same run.

/** @import { Drawing, Place } from "./source.js" */
import { MOST_DEEDS, deedText, parseDeed } from "./deeds.js";
import { cellsOf, known, rowsOf } from "./drawing.js";

/**
 * @typedef {{cells: Place[], seed: number, speed: number, faults: string[], spread: number, until: number | null,
 *   model: string, deeds: import("./deeds.js").Deed[]}} Start
 */

export const DEFAULT_SPEED = 0.1;
// Twin of the least that a command takes (host/tilenca/protocol/stream_commands.py), but for 0.
const LEAST_SPEED = 1e-5;
export const DEFAULT_SPREAD_S = 0.25;
const FIRST_DRAWING = "8";
const EMPTY = "0"; // an own drawing without tiles

/** @param {string | null} text @param {number} low @param {number} high @param {number} otherwise */
function numberIn(text, low, high, otherwise) {
  const value = text === null || text === "" ? NaN : Number(text);
  return value >= low && value <= high ? value : otherwise;
}

/**
 * What the address asks for; what it does not say, or says wrongly, is as usual.
 * @param {string} query from `?` on
 * @param {Drawing[]} drawings
 * @returns {Start}
 */
export function readAddress(query, drawings) {
  const given = new URLSearchParams(query);
  const wanted = given.get("shape");
  const asked = drawings.find((one) => one.name === wanted);
  const shape = asked ?? drawings.find((one) => one.label === FIRST_DRAWING) ?? drawings[0];
  const drawn = cellsOf((given.get("draw") ?? "").split("-"));
  const isDrawn = drawn.length > 0 || given.get("draw") === EMPTY;
  const until = numberIn(given.get("until"), 0, 86400, NaN);
  return {
    cells: isDrawn ? drawn : cellsOf(shape?.rows ?? ["#"]),
    seed: Math.floor(numberIn(given.get("seed"), 0, Number.MAX_SAFE_INTEGER, 0)),
    speed: Number(given.get("speed") || NaN) === 0 ? 0 : numberIn(given.get("speed"), LEAST_SPEED, 1024, DEFAULT_SPEED),
    // Those at a place of a drawing that is not here are not of another one.
    faults: given.getAll("fault").filter((fault) => !fault.includes("@") || isDrawn || !wanted || asked).slice(0, 32),
    spread: numberIn(given.get("spread"), 0, 3600, DEFAULT_SPREAD_S),
    until: Number.isNaN(until) ? null : until,
    model: given.get("model") ?? "",
    deeds: given.getAll("deed").flatMap(parseDeed).slice(0, MOST_DEEDS),
  };
}

/**
 * The query of an address that begins with this.
 * @param {Start} start
 * @param {Drawing[]} drawings
 */
export function writeAddress(start, drawings) {
  const query = new URLSearchParams();
  const drawing = known(start.cells, drawings);
  if (drawing) query.set("shape", drawing.name);
  else query.set("draw", start.cells.length ? rowsOf(start.cells).join("-") : EMPTY);
  query.set("seed", String(start.seed));
  query.set("speed", String(start.speed));
  for (const fault of start.faults) query.append("fault", fault);
  if (start.spread !== DEFAULT_SPREAD_S) query.set("spread", String(start.spread));
  if (start.until !== null) query.set("until", String(start.until));
  if (start.model) query.set("model", start.model);
  for (const deed of start.deeds) query.append("deed", deedText(deed));
  return `?${query.toString().replaceAll("%2C", ",").replaceAll("%2F", "/").replaceAll("%40", "@").replaceAll("%3D", "=")}`;
}
