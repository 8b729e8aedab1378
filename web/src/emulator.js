// The emulator: tiles of ATmega2560s that run a firmware image cycle by cycle.
import { TileArray } from "./array.js";
import { HARDWARE } from "./hardware.js";
import { Module } from "./module.js";

const ABI_VERSION = 2; // TILENCA_EMULATOR_ABI_VERSION
// As array.js and tile.js write and read them, in bytes.
const STRUCTURES = {
  tilenca_wire_fault: 32, tilenca_wire_counts: 24, tilenca_cycles: 24, tilenca_hardware: HARDWARE.bytes,
};

/** An instance of the emulator; its arrays share one memory. */
export class Emulator {
  /** @param {Module} module */
  constructor(module) {
    this.module = module;
  }

  /**
   * @param {import("./module.js").Source} [source] default: the module beside this file, with the blocks of the
   *   firmware it was built for
   */
  static async load(source = new URL("./tilenca_emulator.wasm", import.meta.url)) {
    return new Emulator(await Module.load(source, "emulator", ABI_VERSION, STRUCTURES));
  }

  /**
   * Builds tiles; nothing runs yet.
   * @param {import("./array.js").ArrayOptions} options
   * @throws {import("./module.js").TilencaError} an image cannot be used, or a number is out of range
   */
  array(options) {
    return new TileArray(this.module, options);
  }
}
