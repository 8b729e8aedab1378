// A run of a link, with what other hands did in it: how far it is, the way to its end, and that it is over.

/** @import { Command } from "../stream/source.js" */
/** @import { Run } from "../stream/run.js" */
/** @import { Tiles } from "../stream/tiles.js" */
import { byId, element, setText } from "./dom.js";

export class SharedRun {
  /** @param {Tiles} tiles @param {Run} run @param {(command: Command) => void} send past what notes hands */
  constructor(tiles, run, send) {
    this.tiles = tiles;
    this.run = run;
    this.send = send;
    this.runs = -1;
    this.isGone = false;
    /** Whether it has come to its end: its time is told before it stands. */
    this.hasEnded = false;
    /** The speed before it hurried to the end. @type {number | null} */
    this.before = null;
    this.words = element("span", { role: "status" });
    this.toEnd = element("button", { type: "button", onclick: () => this.hurry() }, "Go to its end");
    this.root = element("p", { class: "shared", id: "shared", hidden: true }, this.words, this.toEnd);
    byId("bar").prepend(this.root);
  }

  /** As fast as it can until the end. */
  hurry() {
    const { pace } = this.tiles;
    this.before ??= pace.speed;
    this.send({ do: "pace", speed: 0, paused: false });
  }

  update() {
    const { tiles, run } = this;
    const end = run.hasBegun ? run.sharedEnd : null;
    if (tiles.runs !== this.runs) Object.assign(this, { runs: tiles.runs, isGone: false, hasEnded: false, before: null });
    const isOver = !run.isBeforeEnd;
    if (end !== null && isOver && this.before !== null) {
      this.send({ do: "pace", speed: this.before, paused: true });
      this.before = null;
    }
    this.hasEnded ||= isOver && (tiles.pace.paused || run.opened?.until == null);
    this.isGone ||= this.hasEnded && isOver && !tiles.pace.paused && this.before === null && tiles.pace.speed > 0;
    const isShown = end !== null && !this.isGone;
    this.root.hidden = !isShown;
    document.body.toggleAttribute("data-shared", isShown && !isOver);
    if (!isShown) return;
    this.toEnd.hidden = isOver;
    // A reader hears its beginning and its end, and not each tenth of a second.
    this.words.setAttribute("aria-live", isOver ? "polite" : "off");
    setText(this.words, isOver ? "End of the shared run; Play goes on" : `A shared run: ${tiles.time.toFixed(1)} of ${end.toFixed(1)} s`);
  }
}
