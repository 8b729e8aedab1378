// The page in a frame of its own site: it tells what it offers, and does what is asked of both runs that are compared.

/** @import { Model } from "../stream/source.js" */
/** @import { Tiles } from "../stream/tiles.js" */
import { known } from "../stream/drawing.js";

/** @typedef {{models: Model[], model: string, drawings: string[], drawing: string}} Here */

/** @param {{pace: (speed: number, paused: boolean) => void, restart: () => void}} deeds */
export function obeyParent(deeds) {
  if (parent === window) return;
  addEventListener("message", ({ origin, source, data }) => {
    if (origin !== location.origin || source !== parent || typeof data?.tilenca !== "object") return;
    const { pace, restart } = data.tilenca;
    if (restart) deeds.restart();
    if (pace) deeds.pace(Number(pace.speed), Boolean(pace.paused));
  });
}

/** @param {Tiles} tiles @param {import("../stream/source.js").Place[]} cells that it begins with */
export function tellParent(tiles, cells) {
  if (parent === window) return;
  const { models, model, drawings } = tiles;
  /** @type {Here} */
  const here = { models, model, drawings: drawings.map(({ name }) => name), drawing: known(cells, drawings)?.name ?? "" };
  try {
    parent.postMessage({ tilenca: { here } }, location.origin);
  } catch {
    // of a file, which has no origin: nobody listens
  }
}
