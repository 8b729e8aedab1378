// The choice of what the tiles' colours tell, and the scale of it below the board.

/** @import { Lens } from "../stream/lens.js" */
/** @import { Tiles } from "../stream/tiles.js" */
import { lensesFor, shadeOf } from "../stream/lens.js";
import { element, setText } from "./dom.js";

const KEY = "look"; // of the address
// Colours of the scale; the browser blends those in between.
const STOPS = 9;

export class LensPanel {
  /**
   * @param {HTMLElement} root @param {HTMLElement} scale @param {Tiles} tiles
   * @param {(lens: Lens | null) => void} choose null: as their LEDs light them
   */
  constructor(root, scale, tiles, choose) {
    this.scale = scale;
    this.tiles = tiles;
    this.choose = choose;
    this.shape = "";
    /** @type {Lens[]} */
    this.lenses = [];
    /** What is wanted, also before the tiles have told that they have it. */
    this.wanted = new URLSearchParams(location.search).get(KEY) ?? "";
    this.select = element("select", { id: "look", title: "L: the next one", onchange: () => this.want(this.select.value) });
    root.append(element("label", { class: "model", for: "look" }, element("span", {}, "Colours"), this.select));
    this.title = element("span", { class: "scale-title" });
    this.ends = [element("span"), element("span")];
    this.ramp = element("span", { class: "ramp" });
    scale.append(this.title, element("span", { class: "scale" }, this.ends[0], this.ramp, this.ends[1]));
    this.update();
  }

  /** @param {string} id of a lens; "": their LEDs */
  want(id) {
    this.wanted = id;
    const query = new URLSearchParams(location.search);
    query.delete(KEY);
    const text = [query.toString(), id && `${KEY}=${encodeURIComponent(id)}`].filter(Boolean).join("&");
    history.replaceState(null, "", `?${text}${location.hash}`);
    this.show();
  }

  /** The next one of the list; back is the one before. @param {number} way 1 or -1 */
  turn(way) {
    const ids = ["", ...this.lenses.map(({ id }) => id)];
    this.want(ids[(ids.indexOf(this.select.value) + way + ids.length) % ids.length]);
  }

  /** Offers what the tiles have, where that is news. */
  update() {
    const first = this.tiles.laid().find((tile) => tile.channels > 0);
    const shape = first ? `${first.channels} ${first.classes} ${this.tiles.looks.map(({ label }) => label)}` : this.shape || "none";
    if (shape === this.shape) return;
    this.shape = shape;
    this.lenses = lensesFor(this.tiles);
    /** @type {Map<string, HTMLElement[]>} */
    const groups = new Map();
    for (const { id, group, name } of this.lenses) {
      groups.set(group, [...(groups.get(group) ?? []), element("option", { value: id }, name)]);
    }
    this.select.replaceChildren(
      element("option", { value: "" }, "Their LEDs"),
      ...[...groups].flatMap(([label, options]) => (label ? [element("optgroup", { label }, ...options)] : options)),
    );
    this.show();
  }

  show() {
    const lens = this.lenses.find(({ id }) => id === this.wanted) ?? null;
    this.select.value = lens?.id ?? "";
    this.scale.hidden = lens === null;
    if (lens) {
      setText(this.title, lens.name);
      this.ends.forEach((end, index) => setText(end, lens.ends[index]));
      const stops = Array.from({ length: STOPS }, (_, index) =>
        `rgb(${shadeOf(lens, lens.low + ((lens.high - lens.low) * index) / (STOPS - 1)).join(" ")})`);
      this.ramp.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
    }
    this.choose(lens);
  }
}
