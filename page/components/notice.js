// One line about something that went wrong or is gone, with a way back where there is one.

import { element } from "./dom.js";

const STAYS_MS = 6000;
const WITH_A_WAY_MS = 15_000;

/** A button in the line. @typedef {{name: string, act: () => void}} Way */

export class Notice {
  /** @param {HTMLElement} root */
  constructor(root) {
    this.root = root;
    this.timer = 0;
    document.addEventListener("close", () => document.body.append(root), true); // of a dialog
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
    const over = document.querySelector("dialog[open]") ?? document.body; // a dialog lies over all that is not in it
    if (this.root.parentElement !== over) over.append(this.root);
    this.root.replaceChildren(text);
    if (way) this.root.append(element("button", { type: "button", onclick: () => {
      this.clear();
      way.act();
    } }, way.name));
    this.root.hidden = false;
  }

  /** A hand does something else: what was said for a while, without a way back, has been read. */
  pass() {
    if (this.timer && !this.root.firstElementChild) this.clear();
  }

  /** What was said until further notice is over. */
  settle() {
    if (this.timer === 0) this.clear();
  }

  clear() {
    clearTimeout(this.timer);
    this.root.hidden = true;
  }
}
