// Real tiles in the side: how each one and its links are, the settings of all, and what has changed.

/** @import { Tile } from "../stream/tile.js" */
/** @import { Tiles } from "../stream/tiles.js" */
import { element, setText } from "./dom.js";
import { Settings } from "./settings.js";

const SHOWN_NOTES = 60;
const MS = 1000;
const DRAW_MS = 250;

/** The share of frames that arrive at a tile, of its worst side; null while none is known. @param {Tile} tile */
function worst(tile) {
  const shares = Object.values(tile.health).map(([, good]) => good).filter((good) => good !== null);
  return shares.length ? Math.min(...shares) : null;
}

/** How a tile is, in a few words. @param {Tile} tile */
function stateOf(tile) {
  if (tile.trouble) return tile.reason && !tile.powered ? tile.reason : tile.trouble;
  if (tile.error) return tile.error;
  const marks = Object.entries(tile.health).filter(([, [mark]]) => mark !== "well");
  if (marks.length) return marks.map(([side, [mark]]) => `${side} ${mark}`).join(", ");
  return tile.frozen ? "frozen" : "well";
}

export class FleetPanel {
  /**
   * @param {HTMLElement} root @param {Tiles} tiles
   * @param {{select: (port: string) => void, set: import("./settings.js").Set}} deeds
   */
  constructor(root, tiles, deeds) {
    this.root = root;
    this.tiles = tiles;
    this.deeds = deeds;
    this.drawn = 0;
    this.last = /** @type {unknown} */ (null);
    /** @type {Map<string, {row: HTMLElement, cells: HTMLElement[], button: HTMLElement}>} */
    this.rows = new Map();
    this.settings = new Settings(tiles, deeds.set, () => null);
    this.body = element("tbody");
    this.log = element("ol", { class: "log", tabindex: 0, "aria-label": "What has changed, the latest first" });
    root.append(
      element("h2", { id: "fleet-title" }, "Tiles"),
      element("p", { class: "summary" }, "As they say themselves over USB.",
        element("span", { "data-needs": "set" }, " To pull one out or to cut a cable, use your hands.")),
      element("table", { class: "links fleet-table" },
        element("thead", {}, element("tr", {}, ...["Tile", "Port", "Arrives", "State"].map((name) => element("th", { scope: "col" }, name)))),
        this.body),
      element("section", { class: "all-tiles", "data-needs": "set", "aria-labelledby": "all-title" },
        element("h3", { id: "all-title" }, "Settings of all tiles"), this.settings.root),
      element("h3", {}, "Log"),
      this.log,
    );
  }

  /** @param {number} now */
  update(now) {
    if (this.root.hidden || now - this.drawn < DRAW_MS) return;
    this.drawn = now;
    this.settings.update();
    const laid = this.tiles.laid().sort((one, other) => (one.number || 999) - (other.number || 999));
    const gone = new Set(this.rows.keys());
    for (const tile of laid) {
      gone.delete(tile.port);
      this.showRow(tile);
    }
    for (const port of gone) {
      this.rows.get(port)?.row.remove();
      this.rows.delete(port);
    }
    const rows = laid.map((tile) => this.rows.get(tile.port)?.row);
    rows.forEach((row, index) => {
      if (row && this.body.children[index] !== row) this.body.insertBefore(row, this.body.children[index] ?? null);
    });
    this.showLog();
  }

  /** @param {Tile} tile */
  showRow(tile) {
    let known = this.rows.get(tile.port);
    if (!known) {
      const button = element("button", { type: "button", onclick: () => this.deeds.select(tile.port) });
      const cells = Array.from({ length: 3 }, () => element("td"));
      const row = element("tr", {}, element("th", { scope: "row" }, button), ...cells);
      known = { row, cells, button };
      this.rows.set(tile.port, known);
    }
    const share = tile.trouble ? null : worst(tile);
    const name = tile.port.startsWith("(") ? "" : tile.port.split("/").at(-1) ?? "";
    const texts = [name, share === null ? "" : `${Math.round(share * 100)} %`, stateOf(tile)];
    setText(known.button, tile.number ? String(tile.number) : "?");
    known.button.setAttribute("aria-label", tile.number ? `Tile ${tile.number}` : `The tile at ${name}`);
    known.cells.forEach((cell, index) => setText(cell, texts[index]));
    known.cells[0].title = tile.port;
    known.row.classList.toggle("bad", texts[2] !== "well" && texts[2] !== "frozen");
  }

  showLog() {
    if (this.last === this.tiles.notes) return;
    this.last = this.tiles.notes;
    this.log.replaceChildren(...this.tiles.notes.slice(-SHOWN_NOTES).reverse().map(({ time, port, text, bad }) => {
      const at = new Date((this.tiles.began + time) * MS).toLocaleTimeString();
      const tile = this.tiles.byPort.get(port);
      const who = tile?.number ? `tile ${tile.number}` : port.split("/").at(-1);
      return element("li", bad ? { class: "bad" } : {}, element("time", {}, at), ` ${who} ${text}`);
    }));
  }
}
