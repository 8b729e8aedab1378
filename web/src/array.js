// Many emulated tiles on one clock.
import { newArray, setHardware } from "./array_new.js";
import { forEach, indexBelow, seedOf, whole } from "./checks.js";
import { TilencaError } from "./module.js";
import { Tile } from "./tile.js";

const SIDES = 4;
const FAULT_BYTES = 32; // of tilenca_wire_fault: four doubles
const COUNTS_BYTES = 24; // of tilenca_wire_counts: three 64-bit numbers
const USUAL_DELAY_S = 260e-6;

/**
 * A cable: a tile, its side, another tile, its side.
 * @typedef {readonly [number, number, number, number]} Link
 */

/** @typedef {import("./array_new.js").Image} Image */
/** @typedef {import("./array_new.js").ArrayOptions} ArrayOptions */

/**
 * What goes wrong in one direction of a cable.
 * @typedef {object} LinkFault
 * @property {number} [loss] share of the bytes that never arrive, 0 to 1
 * @property {number} [flip] share of the data bits that arrive inverted, 0 to 1
 * @property {number} [delayS] seconds more than a cable takes
 * @property {number} [baud] of the bytes on it; default: as the USART at either end is set
 */

/** Tiles in lockstep, made by `Emulator.array`. Free it, since JavaScript does not know how large it is. */
export class TileArray {
  #handle = 0;
  /** Whether the tiles execute translated blocks. */
  isTranslated = false;

  /**
   * @param {import("./module.js").Module} module
   * @param {ArrayOptions} options
   */
  constructor(module, options) {
    this.module = module;
    const tiles = whole("the number of tiles", options.tiles ?? 1);
    const ppm = forEach("clock errors", options.ppm, Math.max(0, tiles), 0);
    const switchOnS = forEach("switch-on times", options.switchOnS, Math.max(0, tiles), 0);
    this.#handle = newArray(module, options, ppm, switchOnS);
    try {
      setHardware(module, this.#handle, options.hardware ?? {}, options.bootloader !== undefined);
      this.#call("set_cable_delay", options.cableDelayS ?? USUAL_DELAY_S);
      this.isTranslated = (options.translated ?? true) && this.#useBlocks();
      for (const link of options.links ?? []) {
        this.link(...link);
      }
    } catch (error) {
      this.free();
      throw error;
    }
  }

  #useBlocks() {
    try {
      this.#call("use_translation", 0);
      return true;
    } catch (error) {
      if (error instanceof TilencaError) {
        return false; // of another image, or there are none
      }
      throw error;
    }
  }

  /** The array as the C interface knows it. */
  get handle() {
    if (this.#handle === 0) {
      throw new TilencaError("the array is freed; build another");
    }
    return this.#handle;
  }

  /**
   * @param {string} name
   * @param {...(number | bigint)} args
   */
  #call(name, ...args) {
    return this.module.call(`array_${name}`, this.handle, ...args);
  }

  /** How many tiles it has. */
  get size() {
    return this.#call("size");
  }

  /** Seconds of emulated time since the array began. */
  get timeS() {
    return this.#call("time");
  }

  /**
   * A tile.
   * @param {number} index from 0
   */
  tile(index) {
    return new Tile(this, indexBelow("tile", index, this.size));
  }

  // --- tiles and cables, also while it runs ---

  /**
   * One more tile, without cables.
   * @param {number} [ppm] its clock error
   * @param {number} [switchOnS] default: now
   */
  addTile(ppm = 0, switchOnS = this.timeS) {
    return this.tile(this.#call("add_tile", ppm, switchOnS));
  }

  /**
   * Switches a tile off and takes its cables away; the others keep their numbers.
   * @param {number} tile
   */
  removeTile(tile) {
    this.#call("remove_tile", indexBelow("tile", tile, this.size));
  }

  /**
   * Lays a cable between two sides.
   * @param {number} tile
   * @param {number} side
   * @param {number} other
   * @param {number} otherSide
   */
  link(tile, side, other, otherSide) {
    this.#call("link", ...this.#end(tile, side), ...this.#end(other, otherSide));
  }

  /**
   * Takes the cable at a side away.
   * @param {number} tile
   * @param {number} side
   */
  unlink(tile, side) {
    this.#call("unlink", ...this.#end(tile, side));
  }

  /**
   * Cuts the cable at a side.
   * @param {number} tile
   * @param {number} side
   */
  cut(tile, side) {
    this.#call("connect", ...this.#end(tile, side), 0);
  }

  /**
   * Mends a cable that was cut.
   * @param {number} tile
   * @param {number} side
   */
  mend(tile, side) {
    this.#call("connect", ...this.#end(tile, side), 1);
  }

  /**
   * Spoils the direction that leaves a side, from now on; `{}` makes it whole again. The seed decides which bytes
   * and bits, as in `tilenca.emulator`.
   * @param {number} tile
   * @param {number} side
   * @param {LinkFault} fault
   * @param {number | bigint} [seed]
   */
  setFault(tile, side, fault, seed = 0) {
    const end = this.#end(tile, side);
    const number = seedOf(seed) * BigInt(this.size * SIDES) + BigInt(tile * SIDES + side);
    this.module.begin(FAULT_BYTES);
    const address = this.module.take(FAULT_BYTES);
    const { loss = 0, flip = 0, delayS = 0, baud = 0 } = fault;
    this.module.view(Float64Array, address, 4).set([loss, flip, delayS, baud]);
    this.#call("set_fault", ...end, address, BigInt.asUintN(64, number));
  }

  /**
   * What the direction that leaves a side has done while it had a fault: bytes that entered it, bytes that it lost,
   * bits that it inverted.
   * @param {number} tile
   * @param {number} side
   */
  faultCounts(tile, side) {
    const end = this.#end(tile, side);
    this.module.begin(COUNTS_BYTES);
    const address = this.module.take(COUNTS_BYTES);
    this.#call("fault_counts", ...end, address);
    const [bytes, lost, flipped] = Array.from(this.module.view(BigUint64Array, address, 3), Number);
    return { bytes, lost, flipped };
  }

  /**
   * @param {number} tile
   * @param {number} side
   * @returns {[number, number]}
   */
  #end(tile, side) {
    return [indexBelow("tile", tile, this.size), indexBelow("side", side, SIDES)];
  }

  // --- time ---

  /**
   * Runs all tiles; ends early while one is halted.
   * @param {number} seconds
   * @throws {TilencaError} a tile has stopped at a fault
   */
  run(seconds) {
    if (this.#call("run", seconds) !== 0) {
      const faults = Array.from({ length: this.size }, (_, index) => this.tile(index).fault);
      throw new TilencaError(faults.find((fault) => fault !== "") ?? "a tile has stopped");
    }
  }

  // --- snapshots ---

  /**
   * Everything that decides about the future.
   * @returns {Uint8Array} a view, valid until the next call of anything; `slice` keeps it
   */
  save() {
    this.module.begin(4);
    const place = this.module.take(4);
    const count = this.#call("save", place);
    return this.module.bytes(this.module.view(Uint32Array, place, 1)[0], count);
  }

  /**
   * Goes to the moment of a snapshot, of this array or another with the same image, here or on another machine.
   * @param {Uint8Array} snapshot
   * @throws {TilencaError} it is no snapshot, or of another image; the array is of no use then, unless another
   *   `restore` succeeds
   */
  restore(snapshot) {
    const address = this.module.allocate(snapshot.length);
    try {
      this.module.bytes(address).set(snapshot);
      this.#call("load", address, snapshot.length);
    } finally {
      this.module.free(address);
    }
  }

  // --- the image ---

  /**
   * Address and size in bytes of a symbol of the ELF file; data memory begins at 0x800000.
   * @param {string} name
   */
  symbol(name) {
    const bytes = new TextEncoder().encode(`${name}\0`);
    this.module.begin(bytes.length + 32);
    const [text, place] = [this.module.take(bytes.length), this.module.take(8)];
    this.module.bytes(text).set(bytes);
    this.#call("symbol", text, place, place + 4);
    const [address, size] = this.module.view(Uint32Array, place, 2);
    return { address, size };
  }

  /**
   * The function that contains a byte of flash, or "".
   * @param {number} address
   */
  functionAt(address) {
    return this.module.text(this.module.address("array_function_at", this.handle, whole("the address", address)));
  }

  // --- translated blocks ---

  /** Counts instructions from now on, for `translated`; before the array runs. */
  countInstructions() {
    this.#call("count_instructions");
  }

  /** C++ that does what the instructions that were counted most do; web/CMakeLists.txt compiles it. */
  translated() {
    return this.module.text(this.module.address("array_translated", this.handle));
  }

  /** Frees the tiles; the array cannot be used afterwards. */
  free() {
    if (this.#handle !== 0) {
      // It returns nothing, and cannot fail.
      this.module.call("array_free", this.#handle);
      this.#handle = 0;
    }
  }
}
