// What the page says while it has lost its source.

import { BROKE_OFF, TOO_MANY_PAGES, WRONG_TOKEN } from "../stream/source.js";

/**
 * @param {number} code of the end of the connection
 * @param {string} refused what the source has said last
 * @param {number} seconds until it is tried again
 */
export function lostWords(code, refused, seconds) {
  const again = `trying again in ${Math.ceil(seconds)} s`;
  switch (code) {
    case WRONG_TOKEN:
      return "The address has not the right token: open the one that tilenca page has printed.";
    case BROKE_OFF:
      return `${refused || "The run broke off"}; reload the page to begin again.`;
    case TOO_MANY_PAGES:
      return `${refused || "Too many pages are open already; close one of them"}; ${again}`;
    default:
      return `The tiles are out of reach; ${again}`;
  }
}
