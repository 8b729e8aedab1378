// One line about something that went wrong or is gone, with a way back where there is one. It lies at the edge of the
// board, where no control is; at the edge of the window, where the board is out of sight; or at the end of a dialog.

import { element } from "./dom.js";

const STAYS_MS = 6000;
const WITH_A_WAY_MS = 15_000;

// Keys that do nothing by themselves.
const LEADING = ["Tab", "Shift", "Control", "Alt", "Meta"];

/** A button in the line. @typedef {{name: string, act: () => void}} Way */

export class Notice {
  /** @param {HTMLElement} root */
  constructor(root) {
    this.root = root;
    this.home = /** @type {HTMLElement} */ (root.parentElement);
    this.timer = 0;
    document.addEventListener("close", () => this.home.append(root), true); // of a dialog
    document.addEventListener("scroll", () => this.place(), { passive: true });
    addEventListener("resize", () => this.place());
    document.addEventListener("pointerdown", ({ target }) => this.root.contains(/** @type {Node} */ (target)) || this.pass(), true);
    document.addEventListener("keydown", ({ key }) => LEADING.includes(key) || this.pass(), true);
  }

  /** Somebody goes on: what was said for a while is read, unless it offers a way back. */
  pass() {
    const isOverTiles = this.home.querySelector(".board.high.low") !== null;
    if (this.timer !== 0 && (isOverTiles || !this.root.querySelector("button"))) this.clear();
  }

  /** Says it for a while. @param {string} text @param {Way | null} [way] */
  say(text, way = null) {
    this.stay(text, way);
    this.timer = window.setTimeout(() => this.clear(), way ? WITH_A_WAY_MS : STAYS_MS);
  }

  /** Says it until `clear`. @param {string} text @param {Way | null} [way] */
  stay(text, way = null) {
    clearTimeout(this.timer);
    this.timer = 0;
    const over = document.querySelector("dialog[open]") ?? this.home; // a dialog lies over all that is not in it
    if (this.root.parentElement !== over) over.append(this.root);
    this.root.replaceChildren(text);
    if (way) this.root.append(element("button", { type: "button", onclick: () => {
      this.clear();
      way.act();
    } }, way.name));
    this.root.hidden = false;
    this.place();
  }

  /** At the edge of the window, where that of the board is out of sight. */
  place() {
    if (this.root.hidden) return;
    this.root.classList.remove("afar");
    const { top, bottom } = this.root.getBoundingClientRect();
    this.root.classList.toggle("afar", this.root.parentElement === this.home && (top < 0 || bottom > innerHeight));
  }

  /** What was said until further notice is over. */
  settle() {
    if (this.timer === 0) this.clear();
  }

  clear() {
    clearTimeout(this.timer);
    this.timer = 0;
    this.root.hidden = true;
  }
}
