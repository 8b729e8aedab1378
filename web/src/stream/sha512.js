// SHA-512 (FIPS 180-4). A browser has its own, but only for pages that came over https or from this machine.

const WORD = 64n;
const ROUNDS = 80;
const BLOCK_BYTES = 128;
const STATE_WORDS = 8;

/**
 * The largest whole number whose power is at most a number.
 * @param {bigint} number
 * @param {bigint} power
 */
function root(number, power) {
  let [low, high] = [0n, 1n << (BigInt(number.toString(2).length) / power + 1n)];
  while (high - low > 1n) {
    const middle = (low + high) / 2n;
    if (middle ** power <= number) low = middle;
    else high = middle;
  }
  return low;
}

/** @param {number} count @returns {bigint[]} the first primes */
function primes(count) {
  /** @type {bigint[]} */
  const found = [];
  for (let number = 2n; found.length < count; number++) {
    if (found.every((prime) => number % prime !== 0n)) found.push(number);
  }
  return found;
}

const PRIMES = primes(ROUNDS);
/** The first 64 bits of the fractions of cube and square roots of primes. */
const CONSTANTS = PRIMES.map((prime) => BigInt.asUintN(64, root(prime << (3n * WORD), 3n)));
const START = PRIMES.slice(0, STATE_WORDS).map((prime) => BigInt.asUintN(64, root(prime << (2n * WORD), 2n)));

/** @param {bigint} word @param {bigint} bits */
const turn = (word, bits) => BigInt.asUintN(64, (word >> bits) | (word << (WORD - bits)));

/** @param {bigint[]} state @param {DataView} view @param {number} offset */
function addBlock(state, view, offset) {
  const words = Array.from({ length: 16 }, (_, place) => view.getBigUint64(offset + 8 * place));
  for (let place = 16; place < ROUNDS; place++) {
    const [early, late] = [words[place - 15], words[place - 2]];
    const mixed = (turn(early, 1n) ^ turn(early, 8n) ^ (early >> 7n)) + (turn(late, 19n) ^ turn(late, 61n) ^ (late >> 6n));
    words.push(BigInt.asUintN(64, words[place - 16] + words[place - 7] + mixed));
  }
  let [a, b, c, d, e, f, g, h] = state;
  for (let round = 0; round < ROUNDS; round++) {
    const one = h + (turn(e, 14n) ^ turn(e, 18n) ^ turn(e, 41n)) + ((e & f) ^ (~e & g)) + CONSTANTS[round] + words[round];
    const two = (turn(a, 28n) ^ turn(a, 34n) ^ turn(a, 39n)) + ((a & b) ^ (a & c) ^ (b & c));
    [h, g, f, e, d, c, b, a] = [g, f, e, BigInt.asUintN(64, d + one), c, b, a, BigInt.asUintN(64, one + two)];
  }
  [a, b, c, d, e, f, g, h].forEach((word, place) => {
    state[place] = BigInt.asUintN(64, state[place] + word);
  });
}

/**
 * The digest of bytes: 64 of them.
 * @param {Uint8Array} bytes
 */
export function sha512(bytes) {
  const blocks = Math.ceil((bytes.length + 17) / BLOCK_BYTES);
  const padded = new Uint8Array(blocks * BLOCK_BYTES);
  padded.set(bytes);
  padded[bytes.length] = 0x80;
  const view = new DataView(padded.buffer);
  view.setBigUint64(padded.length - 8, BigInt(8 * bytes.length));
  const state = [...START];
  for (let offset = 0; offset < padded.length; offset += BLOCK_BYTES) addBlock(state, view, offset);
  const digest = new DataView(new ArrayBuffer(8 * STATE_WORDS));
  state.forEach((word, place) => digest.setBigUint64(8 * place, word));
  return new Uint8Array(digest.buffer);
}
