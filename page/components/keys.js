// Keys that work everywhere on the page, except where one types.

/** @import { Bar, BarDeeds } from "./bar.js" */

/**
 * @param {Bar} bar
 * @param {BarDeeds} deeds
 */
export function listenToKeys(bar, deeds) {
  /** @type {Record<string, () => void>} */
  const keys = {
    h: () => bar.choose("hand"),
    d: () => bar.choose("pencil"),
    k: () => bar.choose("knife"),
    r: () => deeds.restart(),
    s: () => deeds.surprise(),
    ".": () => deeds.step(),
    ",": () => deeds.back(),
    " ": () => bar.toggle(),
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (document.querySelector("dialog[open]")) return;
    const target = /** @type {HTMLElement} */ (event.target);
    if (event.key === " " && target.closest("button, input")) return;
    const act = keys[event.key];
    if (!act) return;
    act();
    event.preventDefault();
  });
}
