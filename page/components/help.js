// The list of keys, as a dialog.

import { element } from "./dom.js";

/** Keys, what they do, and the commands that the source needs for it. @type {[string, string, string?][]} */
const KEYS = [
  ["Tab", "to the board, and to each control"],
  ["← ↑ → ↓", "on the board: to the place beside"],
  ["Enter", "on a tile: look into it; on an empty place: put a tile in"],
  ["Delete", "pull the tile out", "pull"],
  ["Shift and an arrow key", "cut or mend the cable on that side", "cut"],
  ["Ctrl and an arrow key", "move all that hangs together", "shift"],
  ["Esc", "close the tile's details"],
  ["H, G, D, K", "Hand, Group, Draw, Knife", "put"],
  ["P", "pause or go on; so does Space, unless the keyboard is on a button, which it presses", "pace"],
  [". and ,", "one update forward, one back", "seek step"],
  ["Ctrl Z", "to just before the last deed", "put"],
  ["I", "one instruction of the tile that is looked into", "instruct"],
  ["L, Shift L", "the next colours, those before"],
  ["R", "start over", "open"],
  ["S", "surprise me", "arrange"],
  ["?", "this list"],
];

export class Help {
  /** @param {HTMLElement} top for its button */
  constructor(top) {
    const rows = KEYS.flatMap(([key, words, needs]) => {
      /** @type {Record<string, string>} */
      const offered = needs ? { "data-needs": needs } : {};
      return [element("dt", offered, element("kbd", {}, key)), element("dd", offered, words)];
    });
    this.dialog = element("dialog", { class: "share", id: "keys", "aria-labelledby": "keys-title" },
      element("header", {}, element("h2", { id: "keys-title" }, "Keys"),
        element("button", { type: "button", class: "plain", "aria-label": "Close", onclick: () => this.dialog.close() }, "×")),
      element("dl", { class: "keys" }, ...rows));
    document.body.append(this.dialog);
    top.append(element("button", { type: "button", class: "help", title: "Keys (?)", "aria-label": "Keys", onclick: () => this.show() }, "?"));
  }

  show() {
    this.dialog.showModal();
  }
}
