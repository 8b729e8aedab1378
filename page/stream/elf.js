// The flash of a firmware's ELF file: what the segments say that are loaded there. Pure: bytes in, bytes out.

import { ImageError } from "./intel_hex.js";

const MAGIC = [0x7f, 0x45, 0x4c, 0x46, 1, 1]; // 32 bits, little-endian
const LOADED = 1;
/** From here on an AVR's ELF has SRAM, EEPROM and fuses. */
const FLASH_END = 0x800000;

/**
 * The bytes of flash by address.
 * @param {string} name of the file @param {Uint8Array} bytes of it
 * @throws {ImageError}
 */
export function parseElf(name, bytes) {
  if (MAGIC.some((byte, i) => bytes[i] !== byte)) throw new ImageError(`${name}: not an ELF file of a firmware`);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  /** @type {Map<number, number>} */
  const memory = new Map();
  const [table, size, count] = [view.getUint32(28, true), view.getUint16(42, true), view.getUint16(44, true)];
  for (let at = table; at < table + count * size; at += size) {
    const [kind, offset, , address, length] = [0, 4, 8, 12, 16].map((field) => view.getUint32(at + field, true));
    if (kind !== LOADED || address >= FLASH_END) continue;
    bytes.subarray(offset, offset + length).forEach((byte, i) => memory.set(address + i, byte));
  }
  return memory;
}
