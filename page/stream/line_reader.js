// Bytes from a tile in, its lines out; twin of host/tilenca/protocol/line_reader.py. Owns no port and no clock.

import { parseSentence } from "./sentences.js";

const MAX_SENTENCE = 200;
const CANDIDATE = /^\$[^*]*\*../s;
const BREAK = /[\r\n]+|(?=\$)/;

/** Each byte as a character (Latin-1). @param {Uint8Array} bytes */
export function latin1(bytes) {
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return text;
}

export class LineReader {
  #buffer = "";
  #joinedMidway = true;

  /** The lines that the bytes complete: sentences, and damaged ones. @param {Uint8Array} bytes @returns {string[]} */
  feed(bytes) {
    const pieces = (this.#buffer + latin1(bytes)).split(BREAK);
    this.#buffer = pieces.pop() ?? "";
    if (this.#buffer.length > MAX_SENTENCE) {
      pieces.push(this.#buffer);
      this.#buffer = "";
    }
    /** @type {string[]} */
    const lines = [];
    for (const piece of pieces.map((one) => one.trim()).filter(Boolean)) {
      if (!this.#joinedMidway || piece.startsWith("$")) lines.push(...linesOf(piece));
      this.#joinedMidway = false;
    }
    return lines;
  }
}

/** @param {string} piece */
function linesOf(piece) {
  const found = CANDIDATE.exec(piece)?.[0];
  if (found === undefined || !parseSentence(found)) return [piece];
  const rest = piece.slice(found.length).trim();
  return rest ? [found, rest] : [found];
}
