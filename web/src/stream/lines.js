// The lines that a tile says on USB, each with the time of the byte that completed it.

const MOST_BYTES = 200; // MAX_SENTENCE of docs/PROTOCOL.md
const [NEW_LINE, RETURN, DOLLAR] = [0x0a, 0x0d, 0x24];

/** @typedef {{ timeS: number, raw: string }} Line each character of `raw` is a byte */

/** Cuts one tile's bytes into lines: at their ends, and where a sentence begins in the middle of another. */
export class Lines {
  #text = "";
  #isWhole = false;

  constructor() {
    /** @type {Line[]} */
    this.found = [];
  }

  /** Another one that goes on from here. */
  copy() {
    const other = new Lines();
    other.#text = this.#text;
    other.#isWhole = this.#isWhole;
    return other;
  }

  /** @param {ArrayLike<number>} values the bytes @param {ArrayLike<number>} times of each, in seconds */
  feed(values, times) {
    for (let place = 0; place < values.length; place++) {
      const byte = values[place];
      if (byte === NEW_LINE || byte === RETURN || byte === DOLLAR || this.#text.length > MOST_BYTES) this.#end(times[place]);
      if (byte !== NEW_LINE && byte !== RETURN) this.#text += String.fromCharCode(byte);
    }
  }

  /** @param {number} timeS */
  #end(timeS) {
    const raw = this.#text.trim();
    this.#text = "";
    if (raw === "") return;
    // Of the first one the beginning may be missing.
    if (this.#isWhole || raw.startsWith("$")) this.found.push({ timeS, raw });
    this.#isWhole = true;
  }

  /** The lines since the last call. */
  take() {
    const found = this.found;
    this.found = [];
    return found;
  }
}
