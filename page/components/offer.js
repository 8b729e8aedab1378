// What the source cannot do is not offered: elements name the commands that they need in `data-needs`. Those with
// `data-models` stay where one can choose a model: it is the way on while firmware is built, and where that fails. A
// recording has models, too, and no use for another one.

/** @import { Tiles } from "../stream/tiles.js" */

/** @param {Tiles} tiles */
export function offerOnly(tiles) {
  document.body.dataset.source = tiles.source;
  document.body.dataset.kind = tiles.kind;
  for (const one of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-needs]"))) {
    const isOffered = (one.dataset.needs ?? "").split(" ").some((name) => tiles.can(name));
    const isWayOn = one.hasAttribute("data-models") && tiles.models.length > 1 && tiles.source !== "recording";
    one.hidden = !isOffered && !isWayOn;
  }
  for (const one of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-only]"))) {
    one.hidden = ![tiles.kind, tiles.source].includes(one.dataset.only ?? "");
  }
}

/** Why a command goes nowhere. @param {Tiles} tiles */
export function refusal(tiles) {
  return tiles.source === "watched"
    ? "These are real tiles: only a hand at the table can do that."
    : "This is a recording: nothing can be changed in it. Reload the page for running tiles.";
}
