// How much emulated time passes for the time of the wall clock: the twin of `tilenca.page.pace`. Owns no clock.

export const QUANTUM_S = 16e-6;
const SLICE_WALL_S = 1 / 60;
const FIRST_RATE = 1; // emulated seconds a second, until it is known
const WEIGHT = 0.2; // of a new measurement

export class Pace {
  share = 1;
  #rate = FIRST_RATE;
  #owedS = 0;
  #isLate = false;

  /** @param {number} speed times real time; 0: as fast as it can @param {boolean} paused @param {number | null} [untilS] */
  constructor(speed, paused, untilS = null) {
    this.speed = speed;
    this.paused = paused;
    this.untilS = untilS;
  }

  /** Another speed, or a pause, from now on. @param {number} speed @param {boolean} paused */
  set(speed, paused) {
    this.speed = speed;
    this.paused = paused;
    this.#owedS = 0;
    this.share = 1;
  }

  /** The emulated seconds to run for so many of the wall clock. @param {number} wallS @param {number} nowS emulated */
  take(wallS, nowS) {
    if (this.paused) return 0;
    const affordableS = this.#rate * SLICE_WALL_S;
    let runS = affordableS;
    if (this.speed) {
      this.#owedS += wallS * this.speed;
      runS = Math.min(this.#owedS, affordableS);
      this.#isLate = this.#owedS > affordableS;
      const share = this.#owedS > QUANTUM_S ? runS / this.#owedS : 1;
      this.share += WEIGHT * (share - this.share);
    }
    if (this.untilS !== null) runS = Math.min(runS, this.untilS - nowS);
    return runS >= QUANTUM_S ? runS : 0; // very slow motion adds it up
  }

  /** Tells what a slice took, and the time afterwards. @param {number} emulatedS @param {number} wallS @param {number} nowS */
  ran(emulatedS, wallS, nowS) {
    this.#owedS = this.#isLate || !this.speed ? 0 : this.#owedS - emulatedS;
    if (wallS > 0 && emulatedS > 0) this.#rate += WEIGHT * (emulatedS / wallS - this.#rate);
    if (this.untilS !== null && nowS >= this.untilS - QUANTUM_S / 2) {
      this.paused = true;
      this.untilS = null;
    }
  }
}
