// How an array of tiles comes to be: its options, and the calls that make it.
import { HARDWARE, writeHardware } from "./hardware.js";

/** @typedef {import("./array.js").Link} Link */

/**
 * An ELF or Intel HEX file. Messages call it by its name.
 * @typedef {{ name: string, bytes: Uint8Array }} Image
 */

/**
 * @typedef {object} ArrayOptions
 * @property {Image} image what all tiles run
 * @property {Image} [bootloader] for the boot section, where the tiles then start after every reset
 * @property {number} [tiles] how many; default: 1
 * @property {readonly Link[]} [links] the cables
 * @property {ArrayLike<number>} [ppm] each tile's clock error in parts per million; default: none
 * @property {ArrayLike<number>} [switchOnS] when each is switched on, in seconds; default: 0
 * @property {number} [cableDelayS] what a cable takes, 20e-6 to 260e-6; short ones cost time
 * @property {import("./hardware.js").Hardware} [hardware] how far the boards differ from ideal ones; default: as those
 *   of `tilenca.emulator`
 * @property {boolean} [translated] whether to use the module's blocks if they are this image's; it changes nothing
 *   else
 */

/**
 * The array as the C interface knows it.
 * @param {import("./module.js").Module} module
 * @param {ArrayOptions} options
 * @param {Float64Array} ppm
 * @param {Float64Array} switchOnS
 */
export function newArray(module, { image, bootloader }, ppm, switchOnS) {
  const files = bootloader === undefined ? [image] : [image, bootloader];
  const names = files.map((file) => new TextEncoder().encode(`${file.name}\0`));
  const namesBytes = names.reduce((sum, name) => sum + name.length + 16, 0);
  module.begin(namesBytes + ppm.byteLength + switchOnS.byteLength + 32);
  const addresses = [...names, ppm, switchOnS].map((list) => {
    const address = module.take(list.byteLength);
    module.bytes(address).set(new Uint8Array(list.buffer, list.byteOffset, list.byteLength));
    return address;
  });
  const [path, boot] = bootloader === undefined ? [addresses[0], 0] : addresses;
  for (const file of files) {
    module.putFile(file.name, file.bytes);
  }
  try {
    return module.address("array_new", path, boot, ppm.length, ...addresses.slice(-2));
  } finally {
    for (const file of files) {
      module.dropFile(file.name);
    }
  }
}

/**
 * Makes the boards as unkind as they are.
 * @param {import("./module.js").Module} module
 * @param {number} handle of the array
 * @param {import("./hardware.js").Hardware} hardware
 * @param {boolean} hasBootloader
 */
export function setHardware(module, handle, hardware, hasBootloader) {
  module.begin(HARDWARE.bytes);
  const address = module.take(HARDWARE.bytes);
  writeHardware(module.bytes(address, HARDWARE.bytes), hardware, hasBootloader);
  module.call("array_set_hardware", handle, address);
}
