// What a tile is given over EEPROM and USB (docs/PROTOCOL.md sections 3, 5 and 6).

const SETTINGS_VERSION = 2;
const MAX_BRIGHTNESS = 255;
const [CRC_START, CRC_POLYNOMIAL] = [0xffff, 0x1021];

/** CRC-16/IBM-3740. @param {number[]} bytes */
function crc16(bytes) {
  let crc = CRC_START;
  for (const byte of bytes) {
    crc ^= byte << 8;
    for (let bit = 0; bit < 8; bit++) crc = ((crc << 1) ^ (crc & 0x8000 ? CRC_POLYNOMIAL : 0)) & 0xffff;
  }
  return crc;
}

/** @param {number} number @returns {number[]} two bytes, low one first */
const two = (number) => [number & 0xff, number >> 8];

/**
 * The block that a tile reads from EEPROM address 0.
 * @param {number} tileId @param {number} periodMs @param {number} updates 0: for ever
 */
export function settingsBlock(tileId, periodMs, updates) {
  const body = [
    ...new TextEncoder().encode("TN"), SETTINGS_VERSION, tileId, ...two(periodMs), ...two(updates), MAX_BRIGHTNESS, 0,
  ];
  return Uint8Array.from([...body, ...two(crc16(body))]);
}

/** The command that sets one of a tile's settings. @param {string} name @param {number} value */
export const setCommand = (name, value) => framed(`SET,${name},${value}`);

/** The one that lets its display blink. @param {number} seconds */
export const blinkCommand = (seconds) => framed(`BLINK,${seconds}`);

/** The one that does as its button. */
export const restartCommand = () => framed("RESTART");

/** A sentence for a tile. @param {string} body */
function framed(body) {
  const sum = [...body].reduce((all, one) => all ^ one.charCodeAt(0), 0);
  return `$${body}*${sum.toString(16).toUpperCase().padStart(2, "0")}\r\n`;
}
