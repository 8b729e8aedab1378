// Bytes from a tile in, its lines out; twin of host/tilenca/protocol/line_reader.py. Owns no port and no clock.

import { parseSentence } from "./sentences.js";

const MAX_SENTENCE = 200;
const CANDIDATE = /^\$[^*]*\*../s;
const BREAK = /[\r\n]+|(?=\$)/;
const AROUND = /^[ \t\r\n\v\f]+|[ \t\r\n\v\f]+$/g;

/** Without white space around it; 0xA0 is a byte like others. @param {string} text */
const stripped = (text) => text.replace(AROUND, "");

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
    for (const piece of pieces.map(stripped).filter(Boolean)) {
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
  const rest = stripped(piece.slice(found.length));
  return rest ? [found, rest] : [found];
}
