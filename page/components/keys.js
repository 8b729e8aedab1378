// Keys that work everywhere on the page, except where one types.

/** @import { Bar, BarDeeds } from "./bar.js" */
/** @import { LensPanel } from "./lens.js" */

const TYPED_IN = "input:not([type=range], [type=file]), select, textarea, [contenteditable]";
/** What the space key works by itself, where the keyboard has led to it, and not a pointer. */
const PRESSED = "button, summary, input";
const LEADING = /^(Tab|Arrow.*)$/;

/** @typedef {BarDeeds & {undo: () => void}} KeyDeeds */

/**
 * @param {Bar} bar
 * @param {KeyDeeds} deeds
 * @param {LensPanel} lens
 * @param {() => void} instruct one instruction of the tile that is looked into
 * @param {() => void} help shows the list of keys
 */
export function listenToKeys(bar, deeds, lens, instruct, help) {
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
    p: () => bar.toggle(),
    "?": help,
  };
  let isLed = true;
  document.addEventListener("pointerdown", () => (isLed = false), true);
  document.addEventListener("keydown", ({ key }) => (isLed ||= LEADING.test(key)), true);
  document.addEventListener("keydown", (event) => {
    if (event.altKey || event.defaultPrevented || document.querySelector("dialog[open]")) return;
    const target = /** @type {HTMLElement} */ (event.target);
    if (target.closest(TYPED_IN) || (event.key === " " && isLed && target.closest(PRESSED))) return;
    const isUndo = event.key === "z" && !event.shiftKey;
    const act = event.ctrlKey || event.metaKey ? isUndo && deeds.undo : keys[event.key];
    if (!act) return;
    act();
    event.preventDefault();
  });
}
