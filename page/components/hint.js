// What the chosen tool does, on the board itself, until a hand has done it.

/** @import { Tiles } from "../stream/tiles.js" */
/** @import { Tool } from "./hands.js" */
import { setText } from "./dom.js";

/** @type {Record<Tool, string>} */
const WORDS = {
  hand: "Drag a tile off the board",
  group: "Drag a tile to move all that hangs together; drag across cables to break it apart",
  pencil: "Start on an empty place to put tiles in, on a tile to rub out",
  knife: "Drag across cables; click one to mend",
};
const EMPTY = "Click free places, or choose Draw";
// A tool with two ways is known when both were gone.
const BOTH = ["put", "pull"];
const DEEDS = ["put", "pull", "move", "shift", "cut"];

export class Hint {
  /** @param {HTMLElement} root @param {Tiles} tiles */
  constructor(root, tiles) {
    this.root = root;
    this.tiles = tiles;
    /** @type {Tool} */
    this.tool = "hand";
    /** Tools that a hand has used. @type {Set<Tool>} */
    this.known = new Set();
    /** What the pencil has done. @type {Set<string>} */
    this.drawn = new Set();
  }

  /** @param {Tool} tool */
  choose(tool) {
    if (tool !== this.tool && this.drawn.size) this.known.add("pencil");
    this.drawn.clear();
    this.tool = tool;
    this.update();
  }

  /** A hand does something. @param {string} deed */
  note(deed) {
    if (this.tool === "pencil" && BOTH.includes(deed)) this.drawn.add(deed);
    const isKnown = this.tool === "pencil" ? this.drawn.size === BOTH.length : DEEDS.includes(deed);
    if (isKnown) this.known.add(this.tool);
    this.update();
  }

  update() {
    const { tiles, tool } = this;
    const isLost = tiles.byPlace.size === 0 && tool !== "pencil"; // nothing lies there that it could work on
    this.root.hidden = (this.known.has(tool) && !isLost) || !tiles.can("put") || tiles.runs === 0;
    setText(this.root, isLost ? EMPTY : WORDS[tool]);
  }
}
