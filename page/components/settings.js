// A tile's settings, kept in its EEPROM: its period and its brightness, for one tile or for all of them.

/** @import { Tiles } from "../stream/tiles.js" */
import { element } from "./dom.js";

/** @typedef {(name: string, value: number, port: string | null) => void} Set */

/** A number to set; the help is a sentence on it. @typedef {{name: string, title: string, low: number, high: number, step?: number, help?: string}} Field */

/** Those that a hand may set; twin of SETTING_RANGES in host/tilenca/protocol/constants.py. @type {Field[]} */
export const FIELDS = [
  { name: "period", title: "Period (ms)", low: 10, high: 10_000 },
  { name: "brightness", title: "Brightness", low: 0, high: 255 },
];
let count = 0;

/**
 * A number with a button that sets it.
 * @param {Field} field @param {string} whose in words, after what is set @param {(value: number) => void} set
 */
export function numberField({ name, title, low, high, step = 1, help = "" }, whose, set) {
  const id = `${name}-${count++}`;
  const input = element("input", { type: "number", id, min: low, max: high, step, required: true, class: "number", title: help });
  const button = element("button", { type: "submit" }, "Set");
  button.append(element("span", { class: "visually-hidden" }, ` the ${title.toLowerCase().replace(/ \(.*\)/, "")}${whose}`));
  const form = element(
    "form", {
      class: "setting",
      onsubmit: (/** @type {Event} */ event) => {
        event.preventDefault();
        set(Number(input.value));
      },
    },
    element("label", { for: id, title: help }, title), input, button,
  );
  return { name, input, form };
}

/** Shows the value in force, where it is news and nobody types. @param {HTMLInputElement} input @param {string} text */
export function showValue(input, text) {
  if (input.dataset.told === text || document.activeElement === input) return false;
  input.dataset.told = input.value = text;
  return true;
}

export class Settings {
  /**
   * @param {Tiles} tiles @param {Set} set
   * @param {() => string | null} port of the tile that is set; null: all of them
   */
  constructor(tiles, set, port) {
    this.tiles = tiles;
    this.port = port;
    const whose = port() === null ? " of all tiles" : "";
    this.fields = FIELDS.map((field) => numberField(field, whose, (value) => set(field.name, value, port())));
    this.root = element("div", { class: "settings" }, ...this.fields.map(({ form }) => form));
  }

  /** Shows what is in force, where it is news and nobody types. */
  update() {
    const one = this.port();
    const tiles = one === null ? this.tiles.laid().filter((tile) => tile.powered) : [this.tiles.byPort.get(one)];
    for (const { name, input } of this.fields) {
      const values = new Set(tiles.map((tile) => (name === "period" ? tile?.periodMs : tile?.brightness)).filter((value) => value !== undefined));
      const text = values.size === 1 && tiles.some((tile) => tile?.periodMs) ? String([...values][0]) : "";
      if (showValue(input, text)) input.placeholder = values.size > 1 ? "various" : "";
    }
  }
}
