// Frames on the cables (docs/PROTOCOL.md section 1), twin of host/tilenca/protocol/frames.py: bytes in, what a
// tile told its neighbour out.

/** @typedef {{side: number, tile: number, sequence: number, modelId: number, state: number[]}} Frame */

const VERSION = 3;
const HEADER = 5;

/** CRC-16/IBM-3740. @param {number[]} data */
function crc16(data) {
  let crc = 0xffff;
  for (const byte of data) {
    crc ^= byte << 8;
    for (let bit = 0; bit < 8; bit++) crc = ((crc << 1) ^ (crc & 0x8000 ? 0x1021 : 0)) & 0xffff;
  }
  return crc;
}

/** Takes the stuffing out (COBS); null: it is none. @param {number[]} wire @returns {number[] | null} */
function unstuff(wire) {
  /** @type {number[]} */
  const data = [];
  for (let at = 0; at < wire.length; ) {
    const length = wire[at];
    const end = at + length;
    if (length === 0 || end > wire.length) return null;
    data.push(...wire.slice(at + 1, end));
    at = end;
    if (length < 0xff && at < wire.length) data.push(0);
  }
  return data;
}

/**
 * The frame in the bytes between two delimiters; null: damaged, or of another version.
 * @param {string} hex
 * @returns {Frame | null}
 */
export function parseFrame(hex) {
  const data = unstuff((hex.match(/../g) ?? []).map((pair) => parseInt(pair, 16)));
  if (!data || data.length <= HEADER + 2 || data[0] >> 4 !== VERSION || data[0] & 0x0c) return null;
  const crc = data[data.length - 2] | (data[data.length - 1] << 8);
  if (crc16(data.slice(0, -2)) !== crc) return null;
  const state = data.slice(HEADER, -2);
  if (state.includes(0)) return null;
  return { side: data[0] & 3, tile: data[1], sequence: data[2], modelId: data[3] | (data[4] << 8), state };
}
