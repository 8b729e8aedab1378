// What is in one tile: its guess and how sure it is, its channels, its links, its counters.

/** @import { Tile } from "../stream/tile.js" */
/** @import { Tiles } from "../stream/tiles.js" */
import { MESSAGE_OFFSET } from "../stream/sentences.js";
import { SIDES, named } from "../stream/source.js";
import { cssColour } from "../stream/led.js";
import { FULL, channelsOf } from "../stream/lens.js";
import { element, setText } from "./dom.js";
import { offerOnly } from "./offer.js";
import { Program } from "./program.js";
import { Settings, numberField, showValue } from "./settings.js";

// Twin of MAX_SKEW_PPM in host/tilenca/protocol/stream_hands.py.
const MOST_SKEW_PPM = 100_000;
const SIDE_NAMES = ["North", "East", "South", "West"];

/** What the buttons do, by the commands that they need. @type {Record<string, string>} */
const HELP = {
  pull: "Takes it off the board; a click on the empty place puts a tile in",
  power: "Without power it falls silent and forgets what it thinks; switched on, it boots",
  freeze: "It keeps its numbers and sends them on, and thinks no more until Thaw",
  reset: "Starts its program anew, as the reset pin does",
  restart: "Its button: it forgets what it thinks, and begins again without booting",
  blink: "Its light blinks, so that you find it",
  turn: "Turned by a quarter no link works, until it is turned back",
};

/**
 * @typedef {{
 *   select: (port: string | null) => void,
 *   pull: (port: string) => void,
 *   power: (port: string, on: boolean) => void,
 *   freeze: (port: string, on: boolean) => void,
 *   reset: (port: string) => void,
 *   turn: (port: string, on: boolean) => void,
 *   skew: (port: string, ppm: number) => void,
 *   instruct: (port: string, count: number) => void,
 *   press: (port: string) => void,
 *   blink: (port: string) => void,
 *   set: import("./settings.js").Set,
 *   cut: (port: string, side: string, on: boolean) => void,
 * }} InspectorDeeds
 */

/** A number of a state as a bar from the middle. */
class Meter {
  /** @param {string} name @param {string} [colour] */
  constructor(name, colour) {
    this.fill = element("span", { class: "fill" });
    if (colour) this.fill.style.setProperty("--led", colour);
    this.value = element("span", { class: "value" });
    this.row = element("li", {}, element("span", { class: "name" }, name), element("span", { class: "meter" }, this.fill), this.value);
  }

  /** @param {number | undefined} value of -127..127 */
  show(value) {
    const share = (value ?? 0) / FULL;
    this.fill.style.transform = `scaleX(${share.toFixed(3)})`;
    setText(this.value, value === undefined ? "" : String(value));
  }
}

export class Inspector {
  /** @param {HTMLElement} root @param {Tiles} tiles @param {InspectorDeeds} deeds */
  constructor(root, tiles, deeds) {
    this.root = root;
    this.tiles = tiles;
    this.deeds = deeds;
    this.port = "";
    this.shape = "";
    this.scores = element("section", { "aria-label": "Scores" });
    /** @type {Meter[]} */
    this.meters = [];
    /** @type {HTMLElement[][]} */
    this.links = [];
    /** @type {HTMLButtonElement[]} */
    this.cables = [];
    /** @type {HTMLElement[]} */
    this.arrives = [];
    this.facts = element("dl", { class: "facts" });
    this.guess = element("p", { class: "guess", title: "Margin: the best score less the second best; below 8 it is torn, from 64 on sure" });
    /** @param {string} text @param {string} needs @param {() => void} act */
    const button = (text, needs, act) => element("button", { type: "button", "data-needs": needs, title: HELP[needs], onclick: act }, text);
    this.pull = button("Pull out", "pull", () => deeds.pull(this.port));
    this.power = button("", "power", () => deeds.power(this.port, !this.tile?.powered));
    this.freeze = button("", "freeze", () => deeds.freeze(this.port, !this.tile?.frozen));
    this.reset = button("Reset", "reset", () => deeds.reset(this.port));
    this.press = button("Press button", "restart", () => deeds.press(this.port));
    this.blink = button("Blink", "blink", () => deeds.blink(this.port));
    this.turn = button("", "turn", () => deeds.turn(this.port, !this.tile?.turned));
    this.clock = numberField(
      { name: "skew", title: "Clock too fast (ppm)", low: -MOST_SKEW_PPM, high: MOST_SKEW_PPM, help: "Parts per million: with 10,000 it runs one percent too fast" }, "", (ppm) => deeds.skew(this.port, ppm),
    );
    this.program = new Program(tiles, deeds.instruct);
    this.settings = new Settings(tiles, deeds.set, () => this.port);
  }

  /** @param {string | null} port */
  show(port) {
    this.root.hidden = port === null;
    this.port = port ?? "";
    this.program.choose(this.port);
    this.shape = "";
    this.update();
  }

  get tile() {
    return this.tiles.byPort.get(this.port);
  }

  update() {
    const { tile } = this;
    if (this.root.hidden || !tile) return;
    const shape = `${this.port} ${tile.number} ${tile.channels} ${tile.classes} ${this.tiles.runs} ${this.tiles.looks.length}`;
    if (shape !== this.shape) {
      this.shape = shape;
      this.build(tile);
    }
    const label = this.tiles.shown(tile);
    const sure = tile.margin === null || label !== tile.label ? "" : `, ${sureness(tile.margin)}`;
    setText(this.guess, tile.powered ? `It shows ${named(label) || "nothing"}${sure}` : awayWords(tile));
    setText(this.power, tile.powered ? "Power off" : "Power on");
    setText(this.freeze, tile.frozen ? "Thaw" : "Freeze");
    this.freeze.title = this.tiles.source === "watched" ? "The tile keeps it, also without power, until Thaw" : HELP.freeze;
    for (const one of [this.freeze, this.reset, this.press, this.blink]) one.disabled = !tile.powered;
    setText(this.turn, tile.turned ? "Turn back" : "Turn by 90°");
    showValue(this.clock.input, String(tile.skew));
    this.program.update();
    this.settings.update();
    this.meters.forEach((meter, index) => meter.show(
      tile.state.length ? tile.state[index] - MESSAGE_OFFSET : undefined,
    ));
    this.showLinks(tile);
    this.showFacts(tile);
  }

  /** @param {Tile} tile */
  build(tile) {
    const { deeds } = this;
    const hidden = Math.max(0, tile.channels - tile.classes);
    this.meters = channelsOf(tile, this.tiles.looks).map(({ name, look }) => new Meter(name, look && cssColour(look.rgb)));
    const close = element("button", { type: "button", class: "round plain", "aria-label": "Close", onclick: () => deeds.select(null) }, "×");
    this.links = SIDE_NAMES.map(() => Array.from({ length: 3 }, () => element("td")));
    this.cables = SIDE_NAMES.map((_, side) => element("button", { type: "button", onclick: () => {
      const now = this.tile;
      if (now) deeds.cut(now.port, SIDES[side], !this.tiles.isCut(now, side));
    } }));
    this.arrives = SIDE_NAMES.map(() => element("span"));
    const isOurs = this.tiles.can("cut");
    const table = element("table", { class: "links" },
      element("thead", {}, element("tr", {}, ...["Side", "Neighbour", "Heard", "Lost", isOurs ? "Cable" : "Arrives"].map((name) => element("th", { scope: "col" }, name)))),
      element("tbody", {}, ...SIDE_NAMES.map((name, side) => element("tr", {},
        element("th", { scope: "row" }, name), ...this.links[side], element("td", {}, isOurs ? this.cables[side] : this.arrives[side])))));
    this.scores.replaceChildren(element("h3", {}, "What it thinks"), element("ul", { class: "meters scores", "aria-label": "Scores of the classes" }, ...this.meters.slice(hidden).map((meter) => meter.row)));
    const others = element("ul", { class: "meters", "aria-label": "Hidden channels" }, ...this.meters.slice(0, hidden).map((meter) => meter.row));
    this.root.replaceChildren(
      element("header", {}, element("h2", {}, tile.number ? `Tile ${tile.number}` : tile.port), close),
      this.guess,
      this.scores,
      element("div", { class: "deeds" }, this.pull, this.power, this.freeze, this.reset, this.press, this.blink),
      element("section", { "data-needs": "skew", "aria-label": "Faults", class: "settings" }, this.clock.form, this.turn),
      element("h3", {}, "Hidden channels"), others,
      element("h3", {}, "Links"), table,
      element("h3", {}, "Counters"), this.facts,
      this.program.root,
      element("section", { "data-needs": "set", "aria-label": "Settings" }, element("h3", {}, "Settings"), this.settings.root),
    );
    offerOnly(this.tiles);
  }

  /** @param {Tile} tile */
  showLinks(tile) {
    SIDE_NAMES.forEach((name, side) => {
      const link = tile.link[SIDES[side]];
      const other = this.tiles.neighbour(tile, side);
      const [neighbour, heard, lost] = this.links[side];
      const [mark, good] = tile.health[SIDES[side]] ?? ["", null];
      setText(this.arrives[side], mark === "dead" ? "nothing" : mark === "foreign" ? "another model" : good === null ? "" : `${Math.round(good * 100)} %`);
      setText(neighbour, other ? `tile ${other.number}` : "none");
      const isKnown = link && (other || link.received > 0);
      setText(heard, isKnown ? String(link.received) : "");
      setText(lost, isKnown ? String(link.lost + link.corrupt) : "");
      const cable = this.cables[side];
      const isCut = tile.place !== null && this.tiles.isCut(tile, side);
      cable.hidden = !other;
      setText(cable, isCut ? "Mend" : "Cut");
      cable.setAttribute("aria-label", `${isCut ? "Mend" : "Cut"} the cable, ${name.toLowerCase()}`);
    });
  }

  /** @param {Tile} tile */
  showFacts(tile) {
    const { time, board } = tile;
    const facts = [
      ["Updates", String(tile.updates)],
      ["Period", tile.periodMs ? `${tile.periodMs} ms` : ""],
      ["Up for", `${(tile.uptimeMs / 1000).toFixed(1)} s`],
      ["Computes", time ? `${(time.computeUs / 1000).toFixed(1)} ms an update` : ""],
      ["Awake", time ? `${(time.awakePermille / 10).toFixed(0)} % of the time` : ""],
      ["Stack", time ? `${time.stackUnused} bytes never used` : ""],
      ["Supply", board?.supplyMv ? `${(board.supplyMv / 1000).toFixed(1)} V` : ""],
      ["Model", tile.modelId],
      ["Port", this.tiles.kind === "watched" ? tile.port : ""],
      ["Error", tile.error],
    ].filter(([, value]) => value !== "");
    if (this.facts.childElementCount !== facts.length * 2) {
      this.facts.replaceChildren(...facts.flatMap(([name]) => [element("dt", {}, name), element("dd")]));
    }
    facts.forEach(([name, value], index) => {
      setText(this.facts.children[2 * index], name);
      setText(this.facts.children[2 * index + 1], value);
    });
  }
}

/** Why it cannot be heard. @param {Tile} tile */
function awayWords(tile) {
  if (!tile.trouble) return "It has no power";
  return tile.trouble === "away" ? `It is away: ${tile.reason}` : `It has ${tile.trouble}`;
}

/** @param {number} margin the best score less the second best, 0..254 */
function sureness(margin) {
  const words = margin < 8 ? "hardly sure" : margin < 32 ? "fairly sure" : "sure";
  return `${words} (margin ${margin})`;
}
