// Images of the firmware, checked before anything is written to a board; twin of host/tilenca/fleet/image.py.
// Pure: text in, bytes out.

/**
 * An image that can be written: the flash from address 0 to its last byte, with 0xFF where it says nothing,
 * and the id that a tile that runs it gives in its HELLO.
 * @typedef {{name: string, size: number, flash: Uint8Array, firmwareId: string}} Image
 */

/** The stock bootloader owns the last 8 KiB of the ATmega2560's 256 KiB. */
export const APPLICATION_BYTES = 248 * 1024;
/** Some Mega bootloaders take three of these in the data for a call of their monitor, and hang. */
const POISON = 0x21;
const NO_IMAGE = "not an Intel HEX file; choose the firmware.hex that pio run builds";
const AGAIN = "build it again with pio run";
const [DATA, END, SEGMENT, START_SEGMENT, LINEAR, START_LINEAR] = [0, 1, 2, 3, 4, 5];
const LINE_ENDS = /\r\n|[\n\r\v\f\x1c-\x1e]/;
const ERASED = 0xff;

/** What cannot be written; the message says what to do. */
export class ImageError extends Error {}

/** The same of one line of the file; the message begins with its number. */
class RecordError extends ImageError {}

/** The cyclic redundancy check of zlib. @param {Uint8Array} bytes */
export function crc32(bytes) {
  let crc = -1;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit++) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}

/** @param {string} line @returns {number[] | null} its bytes */
function bytesOf(line) {
  if (!/^:(?:[0-9A-Fa-f]{2})*$/.test(line)) return null;
  return (line.slice(1).match(/../g) ?? []).map((pair) => parseInt(pair, 16));
}

/** @param {number} number of the line @param {string} line */
function readRecord(number, line) {
  const raw = bytesOf(line);
  if (!raw) throw new RecordError(`${number}: not an Intel HEX record`);
  if (raw.length < 5 || raw.length !== 5 + raw[0]) throw new RecordError(`${number}: a record of the wrong length`);
  if (raw.reduce((sum, byte) => sum + byte, 0) & 0xff) throw new RecordError(`${number}: wrong checksum`);
  return { offset: raw[1] * 256 + raw[2], kind: raw[3], data: raw.slice(4, -1) };
}

/**
 * The bytes of an Intel HEX file by address.
 * @param {string} text
 * @throws {ImageError} whose message begins with the number of the line
 */
export function parseHex(text) {
  /** @type {Map<number, number>} */
  const memory = new Map();
  const lines = text.split(LINE_ENDS);
  if (lines.at(-1) === "") lines.pop();
  let base = 0;
  for (const [index, line] of lines.entries()) {
    if (!line.trim()) continue;
    const { offset, kind, data } = readRecord(index + 1, line.trim());
    if (kind === END) return memory;
    if (kind === DATA) {
      const start = base + offset;
      if (data.some((_, i) => memory.has(start + i))) {
        throw new RecordError(`${index + 1}: address 0x${start.toString(16).toUpperCase()} is given twice`);
      }
      data.forEach((byte, i) => memory.set(start + i, byte));
    } else if (kind === SEGMENT || kind === LINEAR) {
      if (data.length !== 2) throw new RecordError(`${index + 1}: an address record of ${data.length} bytes`);
      base = (data[0] * 256 + data[1]) * (kind === SEGMENT ? 16 : 65536);
    } else if (kind !== START_SEGMENT && kind !== START_LINEAR) {
      throw new RecordError(`${index + 1}: unknown record type ${kind}`);
    }
  }
  throw new RecordError(`${lines.length}: the end record is missing; the file is truncated`);
}

/**
 * Checks that the bytes by address can be written to a tile.
 * @param {string} name of their file @param {Map<number, number>} memory
 * @returns {Image}
 * @throws {ImageError}
 */
export function checkMemory(name, memory) {
  if (!memory.size) throw new ImageError(`${name}: an image without a byte; ${AGAIN}`);
  const addresses = [...memory.keys()].sort((one, other) => one - other);
  const last = addresses[addresses.length - 1];
  if (last >= APPLICATION_BYTES) {
    throw new ImageError(
      `${name}: reaches address 0x${hex(last)}; below the Mega's bootloader there is room up to ` +
      `0x${hex(APPLICATION_BYTES - 1)}: make the firmware smaller`,
    );
  }
  const at = addresses.find((address) => [0, 1, 2].every((i) => memory.get(address + i) === POISON));
  if (at !== undefined) {
    throw new ImageError(`${name}: the bytes '!!!' at 0x${hex(at)} hang some Mega bootloaders; change what holds them`);
  }
  const flash = new Uint8Array(last + 1).fill(ERASED);
  for (const [address, byte] of memory) flash[address] = byte;
  return { name, size: memory.size, flash, firmwareId: hex(crc32(flash)).padStart(8, "0") };
}

/** @param {number} value */
const hex = (value) => value.toString(16).toUpperCase();

/**
 * The image in an Intel HEX file.
 * @param {string} name @param {Uint8Array} bytes of the file
 * @returns {Image}
 * @throws {ImageError} it is not valid, too large, empty, or holds what hangs a bootloader
 */
export function readImage(name, bytes) {
  const text = bytes.some((byte) => byte > 0x7f) ? "" : new TextDecoder().decode(bytes);
  if (!text.trimStart().startsWith(":")) throw new ImageError(`${name}: ${NO_IMAGE}`);
  try {
    return checkMemory(name, parseHex(text));
  } catch (error) {
    if (error instanceof RecordError) throw new ImageError(`${name}:${error.message}; ${AGAIN}`);
    throw error;
  }
}
