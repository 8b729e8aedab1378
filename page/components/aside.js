// A run that lies aside while a recording is shown: its source stands, and the page goes back to it as it was.

/** @import { Source } from "../stream/source.js" */
/** @import { Recorder } from "../stream/recorder.js" */
/** @import { Run } from "../stream/run.js" */
/** @import { Tiles } from "../stream/tiles.js" */

/** What a source tells goes to the page only while `isOpen`. @typedef {import("../stream/source.js").Listener & {isOpen: boolean, isLost: boolean}} Ears */

export class Aside {
  /** @param {Source} source @param {Ears} ears of it @param {Tiles} tiles @param {Run} run @param {Recorder} recorder */
  constructor(source, ears, tiles, run, recorder) {
    this.source = source;
    this.ears = ears;
    // What the page clears in place is told anew by the jump of `takeUp`.
    this.tiles = { ...tiles, byPort: new Map(), byPlace: new Map(), cut: new Set(), pulses: [] };
    this.run = { ...run, handled: new Set(run.handled), start: run.start && { ...run.start } };
    this.recorder = { ...recorder };
    ears.isOpen = false;
    source.send({ do: "rest", on: true });
  }

  /** The page is of this run again, which stands where it stood. @param {Tiles} tiles @param {Run} run @param {Recorder} recorder */
  takeUp(tiles, run, recorder) {
    const told = { version: tiles.version + 1, jumps: tiles.jumps + 1 }; // never numbers that the page has seen
    Object.assign(tiles, this.tiles, told);
    Object.assign(run, this.run);
    Object.assign(recorder, this.recorder);
    this.ears.isOpen = true;
    this.source.send({ do: "rest", on: false });
    this.source.send({ do: "seek", seconds: tiles.time });
  }
}
