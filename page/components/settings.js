// A tile's settings, kept in its EEPROM: its period and its brightness, for one tile or for all of them.

/** @import { Tiles } from "../stream/tiles.js" */
import { element } from "./dom.js";

/** @typedef {(name: string, value: number, port: string | null) => void} Set */

const FIELDS = [
  { name: "period", title: "Period (ms)", low: 10, high: 10_000 },
  { name: "brightness", title: "Brightness", low: 0, high: 255 },
];
let count = 0;

export class Settings {
  /**
   * @param {Tiles} tiles @param {Set} set
   * @param {() => string | null} port of the tile that is set; null: all of them
   */
  constructor(tiles, set, port) {
    this.tiles = tiles;
    this.port = port;
    this.shown = "";
    this.fields = FIELDS.map(({ name, title, low, high }) => {
      const id = `${name}-${count++}`;
      const input = element("input", { type: "number", id, min: low, max: high, step: 1, required: true, class: "number" });
      const button = element("button", { type: "submit" }, "Set");
      const words = element("span", { class: "visually-hidden" });
      button.append(words);
      const form = element(
        "form", {
          class: "setting",
          onsubmit: (/** @type {Event} */ event) => {
            event.preventDefault();
            set(name, Number(input.value), port());
          },
        },
        element("label", { for: id }, title), input, button,
      );
      words.textContent = ` the ${title.toLowerCase().replace(" (ms)", "")}${port() === null ? " of all tiles" : ""}`;
      return { name, input, form };
    });
    this.root = element("div", { class: "settings" }, ...this.fields.map(({ form }) => form));
  }

  /** Shows what is in force, where it is news and nobody types. */
  update() {
    const one = this.port();
    const tiles = one === null ? this.tiles.laid().filter((tile) => tile.powered) : [this.tiles.byPort.get(one)];
    for (const { name, input } of this.fields) {
      const values = new Set(tiles.map((tile) => (name === "period" ? tile?.periodMs : tile?.brightness)).filter((value) => value !== undefined));
      const text = values.size === 1 && tiles.some((tile) => tile?.periodMs) ? String([...values][0]) : "";
      if (input.dataset.told === text || document.activeElement === input) continue;
      input.dataset.told = input.value = text;
      input.placeholder = values.size > 1 ? "various" : "";
    }
  }
}
