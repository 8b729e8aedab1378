// What is in a tile's chip, in words: flags, registers, and the names and values of variables.

/**
 * Between two instructions. Bytes are in hex.
 * @typedef {{
 *   pc: number, function: string, code: string, registers: string, sreg: number, sp: number, stack: string, cycles: number,
 *   variables: [string, number, number, string][],
 * }} Chip with name, address, size and first bytes of each variable
 */

const FLAGS = "ITHSVNZC"; // from bit 7 on

/** @param {string} hex @returns {string[]} its bytes */
export const pairs = (hex) => hex.match(/../g) ?? [];

/** A number in hex. @param {number} value @param {number} digits */
export const inHex = (value, digits) => `0x${value.toString(16).toUpperCase().padStart(digits, "0")}`;

/** The flags of SREG, each with whether it is set. @param {number} sreg @returns {[string, boolean][]} */
export const flagsOf = (sreg) => [...FLAGS].map((name, index) => [name, ((sreg >> (7 - index)) & 1) === 1]);

/**
 * A name as it is written in C++, as far as it is a plain one: `_ZN7tilenca4Tile4tickEv` is `tilenca::Tile::tick`.
 * @param {string} symbol
 * @returns {string}
 */
export function plainName(symbol) {
  const inside = /^_ZZ(N.+?E)\w*?E(\d+)(.*)$/.exec(symbol); // a variable of a function
  if (inside) return `${plainName(`_Z${inside[1]}`)}()::${inside[3].slice(0, Number(inside[2]))}`;
  const isNested = symbol.startsWith("_ZN");
  if (!isNested && !/^_ZL?\d/.test(symbol)) return symbol.replace(/\.(lto_priv|constprop|isra|part)\.\d+/g, "");
  /** @type {string[]} */
  const parts = [];
  let rest = symbol.slice(isNested ? 3 : 2).replace(/^[VKL]+/, "");
  for (let found = /^L?(\d+)/.exec(rest); found; found = /^L?(\d+)/.exec(rest)) {
    const start = found[0].length;
    parts.push(rest.slice(start, start + Number(found[1])));
    rest = rest.slice(start + Number(found[1]));
    if (!isNested) break;
  }
  const named = parts.filter((part) => !part.startsWith("_GLOBAL__N"));
  return named.length ? named.join("::") : symbol;
}

/** The value of a variable: a number where it has one to four bytes, which lie low byte first. @param {number} size @param {string} hex */
export function valueText(size, hex) {
  if (![1, 2, 4].includes(size)) return pairs(hex).join(" ") + (size > hex.length / 2 ? " …" : "");
  const value = parseInt(pairs(hex).reverse().join(""), 16);
  return `${value} (${inHex(value, 2 * size)})`;
}
