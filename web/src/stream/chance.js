// The chance of Python's `random.Random("a text")`, so that equal seeds are equal runs in the browser and natively.
import { sha512 } from "./sha512.js";

const WORDS = 624; // of the Mersenne Twister's state
const MIDDLE = 397;
const UPPER = 0x80000000;
const LOWER = 0x7fffffff;
const MATRIX = 0x9908b0df;

/**
 * The words of a key: the text and its digest as one number, from the low end.
 * @param {string} text
 */
function keyOf(text) {
  const bytes = new TextEncoder().encode(text);
  const number = [...bytes, ...sha512(bytes)].reverse();
  while (number.length > 1 && number.at(-1) === 0) number.pop();
  const key = new Uint32Array(Math.ceil(number.length / 4));
  number.forEach((byte, place) => {
    key[place >> 2] |= byte << (8 * (place & 3));
  });
  return key;
}

/** @param {number} word @param {number} factor */
const mixed = (word, factor) => Math.imul(word ^ (word >>> 30), factor);

export class Chance {
  #state = new Uint32Array(WORDS);
  #next = WORDS;

  /** @param {string} text of the seed */
  constructor(text) {
    const [state, key] = [this.#state, keyOf(text)];
    state[0] = 19650218;
    for (let place = 1; place < WORDS; place++) state[place] = mixed(state[place - 1], 1812433253) + place;
    let place = 1;
    const step = () => {
      if (++place < WORDS) return;
      state[0] = state[WORDS - 1];
      place = 1;
    };
    for (let turn = 0, from = 0; turn < Math.max(WORDS, key.length); turn++) {
      state[place] = (state[place] ^ mixed(state[place - 1], 1664525)) + key[from] + from;
      step();
      from = (from + 1) % key.length;
    }
    for (let turn = 1; turn < WORDS; turn++) {
      state[place] = (state[place] ^ mixed(state[place - 1], 1566083941)) - place;
      step();
    }
    state[0] = UPPER;
  }

  #twist() {
    const state = this.#state;
    for (let place = 0; place < WORDS; place++) {
      const word = (state[place] & UPPER) | (state[(place + 1) % WORDS] & LOWER);
      state[place] = state[(place + MIDDLE) % WORDS] ^ (word >>> 1) ^ (word & 1 ? MATRIX : 0);
    }
    this.#next = 0;
  }

  /** 32 bits. */
  word() {
    if (this.#next === WORDS) this.#twist();
    let word = this.#state[this.#next++];
    word ^= word >>> 11;
    word ^= (word << 7) & 0x9d2c5680;
    word ^= (word << 15) & 0xefc60000;
    return (word ^ (word >>> 18)) >>> 0;
  }

  /** So many bits, 33 to 64. @param {number} count */
  bits(count) {
    const low = BigInt(this.word());
    return (BigInt(this.word() >>> (64 - count)) << 32n) | low;
  }

  /** @param {number} low @param {number} high */
  uniform(low, high) {
    const [a, b] = [this.word() >>> 5, this.word() >>> 6];
    return low + (high - low) * ((a * 2 ** 26 + b) / 2 ** 53);
  }
}
