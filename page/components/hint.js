// What the chosen tool does, on the board itself, until a hand has done it; once for every browser.

/** @import { Tiles } from "../stream/tiles.js" */
/** @import { Place } from "../stream/source.js" */
/** @import { Tool } from "./hands.js" */
import { telling } from "../stream/drawing.js";
import { setText } from "./dom.js";

/** @type {Record<Tool, string>} */
const WORDS = {
  hand: "Drag a tile out of this frame, and watch the others",
  group: "Drag a tile to move all that hangs together; drag across cables to break it apart",
  pencil: "Drag over empty places to put tiles in, over tiles to rub them out",
  knife: "Drag across cables; click one to mend",
};
const EMPTY = "Click free places, or choose Draw";
// A tool with two ways is known when both were gone.
const BOTH = ["put", "pull"];
const DEEDS = ["put", "pull", "move", "shift", "cut"];
const KEY = "tilenca-known"; // of the browser's storage

/** @returns {Tool[]} */
function remembered() {
  try {
    const tools = JSON.parse(localStorage.getItem(KEY) ?? "[]");
    return Array.isArray(tools) ? tools : [];
  } catch {
    return []; // there is no storage, or it has something else
  }
}

export class Hint {
  /**
   * @param {HTMLElement} root @param {Tiles} tiles
   * @param {{isBusy: () => boolean, name: (port: string) => void}} board whether a tile is looked into; marks the tile that is named
   */
  constructor(root, tiles, board) {
    this.root = root;
    this.tiles = tiles;
    this.board = board;
    /** @type {Tool} */
    this.tool = "hand";
    /** Tools that a hand has used. @type {Set<Tool>} */
    this.known = new Set(remembered());
    /** What the pencil has done. @type {Set<string>} */
    this.drawn = new Set();
    /** The places for which a tile was chosen, and its own. @type {{places: string, place: Place | undefined}} */
    this.chosen = { places: "", place: undefined };
  }

  /** @param {Tool} tool */
  choose(tool) {
    if (tool !== this.tool && this.drawn.size) this.learn("pencil");
    this.drawn.clear();
    this.tool = tool;
    this.update();
  }

  /** A hand does something. @param {string} deed */
  note(deed) {
    if (this.tool === "pencil" && BOTH.includes(deed)) this.drawn.add(deed);
    const isKnown = this.tool === "pencil" ? this.drawn.size === BOTH.length : DEEDS.includes(deed);
    if (isKnown) this.learn(this.tool);
    this.update();
  }

  /** @param {Tool} tool */
  learn(tool) {
    if (this.known.has(tool)) return;
    this.known.add(tool);
    try {
      localStorage.setItem(KEY, JSON.stringify([...this.known]));
    } catch {
      // it is told again with the next visit
    }
  }

  /** The port of a tile without which the others see something else; "" where that is not known. */
  telling() {
    const { tiles } = this;
    const places = `${tiles.drawings.length} ${[...tiles.byPlace.keys()].join(" ")}`;
    if (places !== this.chosen.places) {
      this.chosen = { places, place: telling(tiles.laid().map((tile) => tile.place), tiles.drawings) };
    }
    const { place } = this.chosen;
    return (place && tiles.at(...place)?.port) ?? "";
  }

  update() {
    const { tiles, tool } = this;
    const isLost = tiles.byPlace.size === 0 && tool !== "pencil"; // nothing lies there that it could work on
    const isHidden = (this.known.has(tool) && !isLost) || !tiles.can("put") || tiles.runs === 0 || this.board.isBusy();
    const port = isHidden || isLost || tool !== "hand" ? "" : this.telling();
    this.root.hidden = isHidden;
    this.board.name(port);
    const words = port ? WORDS.hand.replace("a tile", `tile ${tiles.byPort.get(port)?.number}`) : WORDS[tool];
    setText(this.root, isLost ? EMPTY : words);
  }
}
