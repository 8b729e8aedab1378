// Keys that work everywhere on the page, except where one types.

/** @import { Bar, BarDeeds } from "./bar.js" */
/** @import { LensPanel } from "./lens.js" */

const TYPED_IN = "input:not([type=range], [type=file]), select, textarea, [contenteditable]";
/** What the space key works by itself. */
const PRESSED = "button, summary, input";

/**
 * @param {Bar} bar
 * @param {BarDeeds} deeds
 * @param {LensPanel} lens
 * @param {() => void} instruct one instruction of the tile that is looked into
 */
export function listenToKeys(bar, deeds, lens, instruct) {
  /** @type {Record<string, () => void>} */
  const keys = {
    h: () => bar.choose("hand"),
    g: () => bar.choose("group"),
    d: () => bar.choose("pencil"),
    k: () => bar.choose("knife"),
    r: () => deeds.restart(),
    s: () => deeds.surprise(),
    i: instruct,
    l: () => lens.turn(1),
    L: () => lens.turn(-1),
    ".": () => deeds.step(),
    ",": () => deeds.back(),
    " ": () => bar.toggle(),
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (document.querySelector("dialog[open]")) return;
    const target = /** @type {HTMLElement} */ (event.target);
    if (target.closest(TYPED_IN) || (event.key === " " && target.closest(PRESSED))) return;
    const act = keys[event.key];
    if (!act) return;
    act();
    event.preventDefault();
  });
}
