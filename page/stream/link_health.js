// How good a link has been lately; twin of host/tilenca/fleet/link_health.py. Pure.

/** @import { LinkSentence } from "./sentences.js" */

const WINDOW_MS = 10_000;
const FAILING = 0.9;
/** So many damaged frames in the window, and no whole one, come from a tile; noise makes few. */
const GARBLED = 10;

/** The reports of one side over the last 10 s of the tile's own time. */
export class LinkHealth {
  /** @type {LinkSentence[]} */
  #reports = [];

  /** @param {LinkSentence} report */
  take(report) {
    const last = this.#reports.at(-1);
    if (last && (report.uptimeMs < last.uptimeMs || report.received < last.received)) this.#reports = []; // it counts anew
    this.#reports.push(report);
    // The one just before the window stays: from there the window's frames are counted.
    while (this.#reports.length > 1 && report.uptimeMs - this.#reports[1].uptimeMs >= WINDOW_MS) this.#reports.shift();
  }

  /** What the window has of a counter. @param {"received" | "lost" | "corrupt" | "foreign"} counter */
  #since(counter) {
    const [first] = this.#reports;
    return first ? (this.#reports.at(-1) ?? first)[counter] - first[counter] : 0;
  }

  /** The share (0..1) of the frames sent to us that arrived whole; null if there were none. */
  get good() {
    const arrived = this.#since("received");
    const expected = arrived + this.#since("lost"); // a damaged frame leaves a gap like a missing one
    return expected > 0 ? arrived / expected : null;
  }

  /**
   * The mark of a side, as `health` of the stream has it; "" where nobody is.
   * @param {boolean} isLinked whether the tile hears a neighbour there now
   */
  mark(isLinked) {
    if (isLinked) return this.good !== null && this.good < FAILING ? "failing" : "well";
    if (this.#since("foreign") > 0) return "foreign";
    return this.#since("received") === 0 && this.#since("corrupt") >= GARBLED ? "dead" : "";
  }
}
