// The sentences of tiles (docs/PROTOCOL.md section 3), twin of host/tilenca/protocol/sentences.py: as much of
// them as the page shows. Text in, objects out.

/**
 * @typedef {{name: "HELLO", version: number, tile: number, modelId: string, channels: number, classes: number,
 *   periodMs: number, updates: number, firmwareId: string, brightness: number}} Hello
 * @typedef {{name: "TILE", tile: number, uptimeMs: number, updates: number, label: string,
 *   classIndex: number | null, margin: number | null, links: string, state: number[]}} TileSentence
 * @typedef {{name: "LINK", tile: number, uptimeMs: number, side: string, sent: number, received: number,
 *   corrupt: number, lost: number, foreign: number, ageMs: number | null, overruns: number,
 *   neighbour: number | null, neighbourSide: string}} LinkSentence
 * @typedef {{name: "TIME", tile: number, uptimeMs: number, computeUs: number, awakePermille: number,
 *   gapUs: number, stackUnused: number, dropped: number}} TimeSentence
 * @typedef {{name: "CHIP", tile: number, fuses: string[], revision: number | null, serial: number | null}} ChipSentence
 * @typedef {{name: "BOARD", tile: number, uptimeMs: number, supplyMv: number | null, framingErrors: number[],
 *   lowMs: number[]}} BoardSentence
 * @typedef {{name: "ERROR", tile: number, uptimeMs: number, code: string, text: string}} ErrorSentence
 * @typedef {{name: "ACK", tile: number, fields: string[]}} Ack
 * @typedef {{name: "NAK", tile: number, reason: string}} Nak
 * @typedef {Hello | TileSentence | LinkSentence | TimeSentence | ChipSentence | BoardSentence | ErrorSentence | Ack | Nak} Sentence
 */

export const PROTOCOL_VERSION = 3;
export const MESSAGE_OFFSET = 128;

const FRAMED = /^\$([ -)+-~]*)\*([0-9A-F]{2})$/;

/** @param {string} text @returns {number | null} */
const optional = (text) => (text === "" ? null : Number(text));

/** @param {string} text @returns {number[]} */
function bytes(text) {
  const found = text.match(/../g) ?? [];
  return found.map((pair) => parseInt(pair, 16));
}

/** The XOR of all characters. @param {string} text */
function checksum(text) {
  let sum = 0;
  for (let i = 0; i < text.length; i++) sum ^= text.charCodeAt(i);
  return sum;
}

/** @type {Record<string, (f: string[]) => Sentence | null>} */
const PARSERS = {
  HELLO: (f) =>
    (f.length === 10 || f.length === 11) && Number(f[0]) === PROTOCOL_VERSION
      ? {
          name: "HELLO", version: Number(f[0]), tile: Number(f[1]), modelId: f[2], channels: Number(f[3]),
          classes: Number(f[4]), periodMs: Number(f[5]), updates: Number(f[6]), firmwareId: f[8],
          brightness: Number(f[9]),
        }
      : null,
  TILE: (f) =>
    f.length === 8
      ? {
          name: "TILE", tile: Number(f[0]), uptimeMs: Number(f[1]), updates: Number(f[2]), label: f[3],
          classIndex: optional(f[4]), margin: optional(f[5]), links: f[6], state: bytes(f[7]),
        }
      : null,
  LINK: (f) =>
    f.length === 12
      ? {
          name: "LINK", tile: Number(f[0]), uptimeMs: Number(f[1]), side: f[2], sent: Number(f[3]),
          received: Number(f[4]), corrupt: Number(f[5]), lost: Number(f[6]), foreign: Number(f[7]),
          ageMs: optional(f[8]), overruns: Number(f[9]), neighbour: optional(f[10]), neighbourSide: f[11],
        }
      : null,
  TIME: (f) =>
    f.length === 7
      ? {
          name: "TIME", tile: Number(f[0]), uptimeMs: Number(f[1]), computeUs: Number(f[2]),
          awakePermille: Number(f[3]), gapUs: Number(f[4]), stackUnused: Number(f[5]), dropped: Number(f[6]),
        }
      : null,
  CHIP: (f) =>
    f.length === 7
      ? { name: "CHIP", tile: Number(f[0]), fuses: f.slice(1, 5), revision: optional(f[5]), serial: optional(f[6]) }
      : null,
  BOARD: (f) =>
    f.length === 11
      ? {
          name: "BOARD", tile: Number(f[0]), uptimeMs: Number(f[1]), supplyMv: optional(f[2]),
          framingErrors: f.slice(3, 7).map(Number), lowMs: f.slice(7).map(Number),
        }
      : null,
  ERROR: (f) =>
    f.length >= 4
      ? { name: "ERROR", tile: Number(f[0]), uptimeMs: Number(f[1]), code: f[2], text: f.slice(3).join(",") }
      : null,
  ACK: (f) => ({ name: "ACK", tile: Number(f[0]), fields: f.slice(1) }),
  NAK: (f) => ({ name: "NAK", tile: Number(f[0]), reason: f[1] ?? "" }),
};

/** A command to a tile, with its line end (docs/PROTOCOL.md section 6). @param {string} text */
export function framed(text) {
  return `$${text}*${checksum(text).toString(16).toUpperCase().padStart(2, "0")}\r\n`;
}

/** Name and fields of a line with the right checksum and a known name; null of any other. @param {string} raw */
function parts(raw) {
  const found = FRAMED.exec(raw.trim());
  if (!found || checksum(found[1]) !== parseInt(found[2], 16)) return null;
  const [name, ...fields] = found[1].split(",");
  return Object.hasOwn(PARSERS, name) ? { name, fields } : null;
}

/**
 * What a line is about, where the latest one counts: the name of its sentence, and the side of a `LINK`; "" for
 * all lines that are none. Its twins are subject_of of host/tilenca/page/outbox.py and web/src/stream/subject.js.
 * @param {string} raw
 */
export function subjectOf(raw) {
  const found = parts(raw);
  if (found === null) return "";
  return found.name === "LINK" ? `LINK ${found.fields[2]}` : found.name;
}

/**
 * The sentence in a line; null for noise, damage, another version, or an unknown name.
 * @param {string} raw
 * @returns {Sentence | null}
 */
export function parseSentence(raw) {
  const found = parts(raw);
  return found && PARSERS[found.name](found.fields);
}
