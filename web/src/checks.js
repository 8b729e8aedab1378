// What WebAssembly would not notice: it rounds every number it gets, and takes NaN for 0.
import { TilencaError } from "./module.js";

/**
 * The number, which is a whole one.
 * @param {string} what
 * @param {number} value
 */
export function whole(what, value) {
  if (!Number.isSafeInteger(value)) {
    throw new TilencaError(`${what} is ${value}; it must be a whole number`);
  }
  return value;
}

/**
 * The number of that kind at a place: an index below a count.
 * @param {string} what
 * @param {number} index
 * @param {number} count
 */
export function indexBelow(what, index, count) {
  if (!Number.isInteger(index) || index < 0 || index >= count) {
    throw new TilencaError(`${what} ${index} does not exist; there are ${count}`);
  }
  return index;
}

/**
 * A seed as the libraries take it: 64 bits.
 * @param {number | bigint} seed
 */
export function seedOf(seed) {
  return BigInt.asUintN(64, typeof seed === "bigint" ? seed : BigInt(whole("the seed", seed)));
}

/**
 * Numbers for each of so many tiles: those given, or as many of a default.
 * @param {string} what
 * @param {ArrayLike<number> | undefined} given
 * @param {number} count
 * @param {number} otherwise
 */
export function forEach(what, given, count, otherwise) {
  const numbers = given === undefined ? new Float64Array(count).fill(otherwise) : Float64Array.from(given);
  if (numbers.length !== count) {
    throw new TilencaError(`${count} tiles have ${numbers.length} ${what}; give one for each`);
  }
  return numbers;
}

/**
 * A port's letter and the number of its pin, as the libraries take them.
 * @param {string} port
 * @param {number} bit
 * @returns {[number, number]}
 */
export function pinOf(port, bit) {
  if (!/^[A-HJ-L]$/.test(port)) {
    throw new TilencaError(`no port '${port}'; ports are A to L without I`);
  }
  return [port.charCodeAt(0), indexBelow(`pin of port ${port}`, bit, 8)];
}
