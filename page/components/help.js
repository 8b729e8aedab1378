// What hands and keys do, as a dialog.

import { element } from "./dom.js";

/** Without a mouse, and so most often without a keyboard. */
const isTouched = matchMedia("(pointer: coarse)").matches;
const CLICK = isTouched ? "Tap" : "Click";
const click = isTouched ? "tap" : "click";

/** More that a finger does. @type {[string, string, string?][]} */
const TOUCH = [
  ["Tap a slider", "or drag along it: set it", "pace noise"],
  ["Tap the chart", "go to that time", "seek"],
  ["Swipe", "beside the board: scroll the page"],
];

/** What hands do, what comes of it, and the commands that the source needs for it. @type {[string, string, string?][]} */
const HANDS = [
  [`${CLICK} a tile`, "look into it"],
  ["Drag a tile", "move it; out of the frame, or where it says so, take it out", "move"],
  [`${CLICK} an empty place`, "put a tile in", "put"],
  ["Group: drag a tile", `move all that hangs together with it${isTouched ? "" : "; so does Shift with Hand"}`, "shift"],
  ["Group: drag across", "from an empty place over cables: what hangs by these only breaks apart", "shift"],
  ["Draw: drag", `over empty places, put tiles in; over tiles, rub them out; ${click} does it for one`, "put"],
  ["Knife: drag across", `cut cables; ${click} one to mend it`, "cut"],
  ...(isTouched ? TOUCH : []),
];

/** Keys, what they do, and the same. @type {[string, string, string?][]} */
const KEYS = [
  ["Tab", "to the board, and to each control"],
  ["← ↑ → ↓", "on the board: to the place beside"],
  ["Enter", "on a tile: look into it; on an empty place: put a tile in"],
  ["Delete", "pull the tile out", "pull"],
  ["Shift and an arrow", "cut or mend the cable on that side", "cut"],
  ["Ctrl and an arrow", "move all that hangs together", "shift"],
  ["Esc", "close the tile's details"],
  ["H, G, D, K", "Hand, Group, Draw, Knife", "put"],
  ["P", "pause or go on; so does Space, unless the keyboard is on a button, which it presses", "pace"],
  [". and ,", "one update forward, one back", "seek step"],
  ["Ctrl Z", "take the last deed back", "put"],
  ["I", "one instruction of the tile that is looked into", "instruct"],
  ["L, Shift L", "the next colours, those before"],
  ["R", "start over", "open"],
  ["S", "surprise me", "arrange"],
  ["?", "this list"],
];

export class Help {
  /** @param {HTMLElement} top for its button */
  constructor(top) {
    /** @param {[string, string, string?][]} lines */
    const list = (lines) => element("dl", { class: "keys" }, ...lines.flatMap(([key, words, needs]) => {
      /** @type {Record<string, string>} */
      const offered = needs ? { "data-needs": needs } : {};
      return [element("dt", offered, element("kbd", {}, key)), element("dd", offered, words)];
    }));
    this.dialog = element("dialog", { class: "share", id: "keys", "aria-labelledby": "keys-title" },
      element("header", {}, element("h2", { id: "keys-title" }, "Help"),
        element("button", { type: "button", class: "plain", "aria-label": "Close", onclick: () => this.dialog.close() }, "×")),
      element("div", { class: "helps" },
        element("section", {}, element("h3", {}, "On the board"), list(HANDS)),
        element("details", { open: !isTouched }, element("summary", {}, "Keys"), list(KEYS))));
    document.body.append(this.dialog);
    top.append(element("button", { type: "button", class: "help", title: "Help (?)", "aria-label": "Help", onclick: () => this.show() }, "?"));
  }

  show() {
    this.dialog.showModal();
  }
}
