// What is left when something else begins, and the way back to it.

/** @import { Command } from "../stream/source.js" */
/** @import { Run } from "../stream/run.js" */
/** @import { Tiles } from "../stream/tiles.js" */
/** @import { Notice } from "./notice.js" */
import { isDeed } from "../stream/deeds.js";

export class Left {
  /** @param {Tiles} tiles @param {Run} run @param {Notice} notice */
  constructor(tiles, run, notice) {
    this.tiles = tiles;
    this.run = run;
    this.notice = notice;
  }

  /** Whether there is a future that a deed would end. */
  get isPast() {
    const { time, end, stepS } = this.tiles;
    return end !== null && time < end - stepS / 2;
  }

  /** @param {string} text @param {string | null} query of the address of what is left; null: it has none */
  tell(text, query) {
    const way = { name: "Back to that", act: () => location.assign(query + location.hash) };
    this.notice.say(query === null ? `${text} Too much was done in it for a way back.` : text, query === null ? null : way);
  }

  /** A hand is about to do something. @param {Command} command */
  note(command) {
    const { time, end } = this.tiles;
    if (end === null || !this.isPast || !isDeed(command)) return;
    this.tell(`Another future begins at ${time.toFixed(2)} s; the one until ${end.toFixed(2)} s is left.`, this.run.link(end));
  }

  /** Another run is about to begin, which counts where hands have done something in this one. */
  leave() {
    const { tiles, run } = this;
    if (run.hasBegun && run.isOwn && tiles.deeds.length) this.tell(`The run until ${tiles.time.toFixed(2)} s is left.`, run.link());
  }

  /** All tiles are about to be taken off the board. @param {(seconds: number) => void} go to a time of the run */
  clear(go) {
    if (this.isPast || this.tiles.end === null) return; // or it is told already
    const before = Math.max(0, this.tiles.time - this.tiles.stepS);
    this.notice.say("The tiles that lay there are off the board.", { name: `Go back to ${before.toFixed(2)} s`, act: () => go(before) });
  }
}
