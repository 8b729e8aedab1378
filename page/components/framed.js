// The page in a frame of its own site: it tells what it offers and how far it is, and does what is asked of both runs that
// are compared. Time is that of both there: what a hand does to it in one is asked for, and comes back.

/** @import { Command, Model } from "../stream/source.js" */
/** @import { Tiles } from "../stream/tiles.js" */
import { known } from "../stream/drawing.js";
import { faultWords, withLoss } from "../stream/faults.js";

/** @typedef {{models: Model[], model: string, drawings: string[], drawing: string}} Here */
/**
 * How far a run is: `since` when all tiles show `label`, or null; `query` is the address of what lies there now,
 * and `faults` are those of it in words, but for losses on all cables.
 * @typedef {{time: number, end: number | null, paused: boolean, jumps: number, stepS: number, since: number | null, label: string, changes: number, query: string, faults: string[]}} Now
 */
/** @typedef {{pace?: {speed: number, paused: boolean}, restart?: boolean, step?: boolean, seek?: number}} Wish */
/** @typedef {{pace: (speed: number, paused: boolean) => void, restart: () => void, step: () => void}} TimeDeeds */

const isFramed = parent !== window;
/** Whether this is one of two runs that are compared. */
export const isCompared = isFramed && new URLSearchParams(location.search).get("embed") === "compare";

/** @param {object} message */
function tell(message) {
  if (!isFramed) return;
  try {
    parent.postMessage({ tilenca: message }, location.origin);
  } catch {
    // of a file, which has no origin: nobody listens
  }
}

/** Asks for time of both runs. @param {Wish} wish */
export const ask = (wish) => tell({ wish });

/** @param {TimeDeeds} deeds @param {(seconds: number) => void} go to a time @param {(command: Command) => void} send */
export function obeyParent(deeds, go, send) {
  if (!isCompared) return;
  const own = { ...deeds };
  Object.assign(deeds, /** @type {TimeDeeds} */ ({
    pace: (speed, paused) => ask({ pace: { speed, paused } }),
    restart: () => ask({ restart: true }),
    step: () => ask({ step: true }),
  }));
  addEventListener("message", ({ origin, source, data }) => {
    if (origin !== location.origin || source !== parent || typeof data?.tilenca !== "object" || !data.tilenca) return;
    const { pace, restart, step, seek } = data.tilenca;
    if (restart) own.restart();
    if (pace) own.pace(Number(pace.speed), Boolean(pace.paused));
    if (step) send({ do: "step", seconds: Number(step) });
    if (seek !== undefined) go(Number(seek));
  });
}

/** Tells what one can choose from. @param {Tiles} tiles @param {import("../stream/source.js").Place[]} cells that it begins with */
export function tellParent(tiles, cells) {
  const { models, model, drawings } = tiles;
  /** @type {Here} */
  const here = { models, model, drawings: drawings.map(({ name }) => name), drawing: known(cells, drawings)?.name ?? "" };
  tell({ here });
}

/** Tells how far the run is. @param {Tiles} tiles */
export function tellNow(tiles) {
  if (!isCompared) return;
  const { time, end, jumps, stepS, history } = tiles;
  const { since, label } = history.agreedAt(time);
  const faults = withLoss(new URLSearchParams(location.search).getAll("fault"), 0).map((fault) => faultWords(fault, tiles.laid()));
  /** @type {Now} */
  const now = { time, end, paused: tiles.pace.paused, jumps, stepS, since, label, changes: history.changesUntil(time), query: location.search, faults };
  tell({ now });
}
