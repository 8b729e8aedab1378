// The frames on the cables of an array, while cables come and go.
import { SOUTH } from "../sides.js";
import { endsOf, ifThere, turned } from "./faults.js";

/** @typedef {import("../array.js").Link} Link */
/** @typedef {{ timeS: number, tile: number, side: number, data: string }} CableFrame `data`: bytes in hex */

/** Listens at cables, in both directions. */
export class Traffic {
  /** @type {Map<string, { tile: number, side: number, probe: import("../probe.js").Probe, frame: string, isMidway: boolean }>} */
  #taps = new Map();

  /** @param {import("../array.js").TileArray} array */
  constructor(array) {
    this.array = array;
  }

  /** Listens at a cable from now on; a side without USART is read at the cable's other end. @param {Link} cable */
  watch(cable) {
    for (const [tile, side, other, otherSide] of [cable, turned(cable)]) {
      const probe = side === SOUTH
        ? this.array.tile(other).tap(otherSide, { receiving: true })
        : this.array.tile(tile).tap(side);
      this.#taps.set(`${tile},${side}`, { tile, side, probe, frame: "", isMidway: false });
    }
  }

  /** Listens no more at a cable. @param {Link} cable */
  forget(cable) {
    for (const end of endsOf(cable)) {
      this.#taps.get(end.join())?.probe.free();
      this.#taps.delete(end.join());
    }
  }

  /** The array has gone to another moment, with these cables; a frame may be on its way there. @param {readonly Link[]} cables */
  restart(cables) {
    for (const { probe } of this.#taps.values()) ifThere(() => probe.free());
    this.#taps.clear();
    for (const cable of cables) this.watch(cable);
    for (const tap of this.#taps.values()) tap.isMidway = true;
  }

  /** The frames that have ended since the last call, in order of their ends. */
  read() {
    /** @type {CableFrame[]} */
    const seen = [];
    for (const tap of this.#taps.values()) {
      for (let got = tap.probe.bytes(); got.values.length > 0; got = tap.probe.bytes()) {
        got.values.forEach((value, place) => {
          if (value !== 0) {
            tap.frame += value.toString(16).padStart(2, "0");
          } else if (tap.frame) {
            const { tile, side, frame, isMidway } = tap;
            if (!isMidway) seen.push({ timeS: got.times[place], tile, side, data: frame });
            tap.isMidway = false; // the beginning of the first one is missing
            tap.frame = "";
          }
        });
      }
    }
    return seen.sort((one, two) => one.timeS - two.timeS || one.tile - two.tile || one.side - two.side);
  }
}
