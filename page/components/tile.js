// One tile as the board looks: its digit, its light, the lamps of its links, its counters.

/** @import { Lens } from "../stream/lens.js" */
/** @import { Tile } from "../stream/tile.js" */
import { SIDES, sideWords } from "../stream/source.js";
import { cssColour } from "../stream/led.js";
import { inkOn, seenThrough, shadeOf } from "../stream/lens.js";
import { element, setText, svg } from "./dom.js";

// A digit of 100 x 100, segments a to g, and the point.
export const SEGMENTS = [
  "M36 20H64", "M69 25V45", "M69 55V75", "M36 80H64", "M31 55V75", "M31 25V45", "M37 50H63",
];
/** Where the lamps are. */
export const LAMPS = [[50, 8], [92, 50], [50, 92], [8, 50]];

export class TileView {
  /** @param {Tile} tile */
  constructor(tile) {
    this.port = tile.port;
    this.glow = svg("g", { class: "glow" });
    this.lit = svg("g", { class: "lit" });
    const unlit = svg("g", { class: "unlit" }, ...SEGMENTS.map((d) => svg("path", { d })));
    this.lamps = LAMPS.map(([cx, cy]) => svg("circle", { cx, cy, r: 2.6, class: "lamp" }));
    this.id = svg("text", { x: 11, y: 20, class: "id" });
    this.counter = svg("text", { x: 87, y: 91, class: "counter" });
    this.face = svg(
      "svg", { viewBox: "0 0 100 100", "aria-hidden": "true" },
      svg("title", {}, new Text("Upper left: its number. Lower right: its updates, or what its colour tells")), unlit, this.glow, this.lit, ...this.lamps, this.id, this.counter,
    );
    this.mark = element("span", { class: "state-mark", "aria-hidden": "true" });
    this.button = element("button", { type: "button", class: "tile", tabindex: -1, "data-port": tile.port }, this.mark);
    this.button.append(this.face);
    this.segments = -1;
    this.said = "";
    this.shadeText = "";
  }

  /** @param {Tile} tile @param {string} label that it shows @param {boolean} isSelected @param {Lens | null} lens what its colour tells; null: its LED */
  update(tile, label, isSelected, lens) {
    const colour = cssColour(tile.rgb);
    if (this.segments !== tile.segments) {
      this.segments = tile.segments;
      const d = SEGMENTS.filter((_, bit) => (tile.segments >> bit) & 1).join("");
      for (const layer of [this.glow, this.lit]) layer.replaceChildren(svg("path", { d }));
    }
    if (this.button.style.getPropertyValue("--led") !== colour) {
      this.button.style.setProperty("--led", colour);
      this.button.classList.toggle("dark", tile.rgb.every((part) => part === 0));
    }
    this.lamps.forEach((lamp, side) => lamp.classList.toggle("on", tile.leds[side] === SIDES[side]));
    setText(this.id, tile.number ? String(tile.number) : "?");
    const seen = lens && seenThrough(lens, tile);
    this.shade(lens, seen);
    setText(this.counter, lens ? String(seen ?? "") : tile.powered ? String(tile.updates) : "");
    const mark = tile.trouble || (!tile.powered ? "off" : tile.frozen ? "frozen" : tile.turned ? "turned" : "");
    this.button.classList.toggle("turned", tile.turned);
    this.button.dataset.state = mark;
    setText(this.mark, mark);
    const words = describe(tile, label, lens && (seen === null ? `no ${lens.unit}` : `${lens.unit} ${seen}`));
    if (words !== this.said) {
      this.said = words;
      this.button.setAttribute("aria-label", words);
    }
    this.button.setAttribute("aria-pressed", String(isSelected));
  }

  /** Colours the face by a value; null: not at all. @param {Lens | null} lens @param {number | null} value */
  shade(lens, value) {
    const colour = lens && value !== null ? shadeOf(lens, value) : null;
    const text = colour ? `rgb(${colour.join(" ")})` : "";
    if (this.shadeText === text) return;
    this.shadeText = text;
    this.button.classList.toggle("shaded", colour !== null);
    this.button.style.setProperty("--shade", text);
    this.button.style.setProperty("--on-shade", colour ? inkOn(colour) : "");
  }
}

/** What hands have done to it. @param {Tile} tile */
function spoiltWords({ frozen, turned, skew }) {
  const clock = skew ? `clock ${Math.abs(skew)} ppm ${skew > 0 ? "fast" : "slow"}` : "";
  return [frozen ? "frozen" : "", turned ? "turned by 90 degrees" : "", clock].filter(Boolean).join(", ");
}

/** What a screen reader says of a tile. @param {Tile} tile @param {string} label that it shows @param {string | null} seen what its colour tells */
function describe(tile, label, seen) {
  const links = [...SIDES].filter((letter, side) => tile.leds[side] === letter).map(sideWords);
  const place = tile.place ? `, row ${tile.place[0] + 1}, column ${tile.place[1] + 1}` : "";
  if (!tile.powered) return `Tile ${tile.number}${place}, ${tile.trouble ? `${tile.trouble}, ${tile.reason}` : "no power"}`;
  const shows = label === "" ? "shows nothing yet" : label === "-" ? "shows a dash" : `shows ${label}`;
  const linked = links.length ? `linked ${links.join(", ")}` : "no links";
  return [`Tile ${tile.number}${place}`, shows, seen, linked, spoiltWords(tile), tile.trouble].filter(Boolean).join(", ");
}
