// One line about something that went wrong.

import { setText } from "./dom.js";

const STAYS_MS = 6000;

export class Notice {
  /** @param {HTMLElement} root */
  constructor(root) {
    this.root = root;
    this.timer = 0;
    document.addEventListener("close", () => document.body.append(root), true); // of a dialog
  }

  /** Says it for a while. @param {string} text */
  say(text) {
    this.stay(text);
    this.timer = window.setTimeout(() => this.clear(), STAYS_MS);
  }

  /** Says it until `clear`. @param {string} text */
  stay(text) {
    clearTimeout(this.timer);
    const over = document.querySelector("dialog[open]") ?? document.body; // a dialog lies over all that is not in it
    if (this.root.parentElement !== over) over.append(this.root);
    setText(this.root, text);
    this.root.hidden = false;
  }

  clear() {
    clearTimeout(this.timer);
    this.root.hidden = true;
  }
}
