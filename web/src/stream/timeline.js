// The past of a run: moments to go back to, and what hands did when: the twin of `tilenca.page.timeline`. Owns no tiles.
import { QUANTUM_S } from "./pace.js";

const EVERY_S = 0.05; // emulated, between two moments, where there is room
const MOST_BYTES = 64_000_000;
const HALF_S = QUANTUM_S / 2;

/**
 * @template M, D
 */
export class Timeline {
  /** @type {{ timeS: number, moment: M, bytes: number }[]} */
  #kept = [];
  /** @type {{ timeS: number, deed: D }[]} */
  #deeds;
  /** The time that the run has reached; beyond it nothing is known. */
  endS = 0;

  /** Nothing has run yet. @param {readonly { timeS: number, deed: D }[]} [deeds] to be done, in order of time */
  constructor(deeds = []) {
    this.#deeds = [...deeds];
  }

  /** How many moments begin at a time or before. @param {number} timeS */
  #before(timeS) {
    const place = this.#kept.findLastIndex((kept) => kept.timeS <= timeS);
    return place + 1;
  }

  /** Whether a moment should be kept now. @param {number} nowS */
  isDue(nowS) {
    const before = this.#before(nowS + HALF_S);
    return before === 0 || nowS - this.#kept[before - 1].timeS >= EVERY_S - HALF_S;
  }

  /** Keeps a moment of so many bytes. @param {number} nowS @param {M} moment @param {number} bytes */
  keep(nowS, moment, bytes) {
    this.#kept.splice(this.#before(nowS), 0, { timeS: nowS, moment, bytes });
    this.endS = Math.max(this.endS, nowS);
    while (this.#kept.length > 2 && this.#kept.reduce((sum, kept) => sum + kept.bytes, 0) > MOST_BYTES) {
      this.#kept.splice(this.#least(nowS), 1);
    }
  }

  /** The moment that is missed least: neither the first nor the last. @param {number} nowS */
  #least(nowS) {
    let [least, smallest] = [1, Infinity];
    for (let place = 1; place < this.#kept.length - 1; place++) {
      const [before, after] = [this.#kept[place - 1].timeS, this.#kept[place + 1].timeS];
      const gap = (after - before) / (Math.abs(nowS - before) + EVERY_S);
      if (gap < smallest) [least, smallest] = [place, gap];
    }
    return least;
  }

  /** A hand has done something: the future that was known is void, and the moment of now. @param {number} nowS @param {D} deed */
  note(nowS, deed) {
    this.endAt(nowS);
    this.#kept = this.#kept.filter(({ timeS }) => timeS < nowS - HALF_S);
    this.#deeds.push({ timeS: nowS, deed });
  }

  /** What was known and planned beyond is void. @param {number} nowS */
  endAt(nowS) {
    this.#deeds = this.#deeds.filter(({ timeS }) => timeS <= nowS + HALF_S);
    this.#kept = this.#kept.filter(({ timeS }) => timeS <= nowS + HALF_S);
    this.endS = nowS;
  }

  /** A deed that cannot be done is not done again. @param {{ timeS: number, deed: D }} planned */
  forget(planned) {
    this.#deeds = this.#deeds.filter((one) => one !== planned);
  }

  /** The run has come to a time. @param {number} nowS */
  reached(nowS) {
    this.endS = Math.max(this.endS, nowS);
  }

  /** What hands did after a time, up to another. @param {number} fromS @param {number} toS */
  deedsIn(fromS, toS) {
    return this.#deeds.filter(({ timeS }) => fromS + HALF_S < timeS && timeS <= toS + HALF_S);
  }

  /** The last moment before a time, or the first of all. @param {number} timeS */
  nearest(timeS) {
    return this.#kept[Math.max(this.#before(timeS + HALF_S), 1) - 1];
  }
}
