// The frames on the cables of an array, while cables come and go.
import { SOUTH } from "../sides.js";
import { endsOf, turned } from "./faults.js";

/** @typedef {import("../array.js").Link} Link */
/** @typedef {{ timeS: number, tile: number, side: number, data: string }} CableFrame `data`: bytes in hex */

/** Listens at cables, in both directions. */
export class Traffic {
  /** @type {Map<string, { tile: number, side: number, probe: import("../probe.js").Probe, frame: string }>} */
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
      this.#taps.set(`${tile},${side}`, { tile, side, probe, frame: "" });
    }
  }

  /** Listens no more at a cable. @param {Link} cable */
  forget(cable) {
    for (const end of endsOf(cable)) {
      this.#taps.get(end.join())?.probe.free();
      this.#taps.delete(end.join());
    }
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
            seen.push({ timeS: got.times[place], tile: tap.tile, side: tap.side, data: tap.frame });
            tap.frame = "";
          }
        });
      }
    }
    return seen.sort((one, two) => one.timeS - two.timeS || one.tile - two.tile || one.side - two.side);
  }
}
