// Single instructions of one tile, as a debugger takes them, and what is in its chip: the twin of
// `tilenca.page.stepper`.
import { event, portName } from "./teller.js";

const REGISTERS = 32;
const STACK_POINTER = 0x5d;
const DATA_SPACE = 0x800000;
const [SRAM_START, SRAM_END] = [0x200, 0x2200];
const MOST_BYTES = 16; // of a variable, and of the stack
const CODE_BYTES = 4; // of the longest instruction

/** @param {ArrayLike<number>} bytes */
const hex = (bytes) => Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");

/** Halts one tile of an array at a time, between two of its instructions; the others wait for it. */
export class Stepper {
  /** @type {number | null} */
  #halted = null;
  /** @type {{ name: string, address: number, size: number }[] | null} */
  #variables = null;

  /** @param {import("../array.js").TileArray} array */
  constructor(array) {
    this.array = array;
  }

  /** @param {string} name @param {number} tile */
  #call(name, tile) {
    return this.array.module.call(`tile_${name}`, this.array.handle, tile);
  }

  /** Executes so many instructions, as far as the tile does not sleep on for a second. @param {number} tile @param {number} count */
  step(tile, count) {
    for (let done = 0; done < count; done++) {
      if (this.#halted !== tile) {
        this.release();
        this.#call("halt", tile);
        this.#halted = tile;
      }
      if (!this.#call("step", tile)) return;
    }
  }

  /** Lets the halted tile go on with the next run of the array; returns whether there was one. */
  release() {
    if (this.#halted === null) return false;
    this.#call("resume", this.#halted);
    this.#halted = null;
    return true;
  }

  /** What is in a tile's chip. @param {number} index */
  tell(index) {
    const tile = this.array.tile(index);
    const [low, high] = tile.readMemory(STACK_POINTER, 2);
    const stack = low | (high << 8);
    const above = Math.max(0, Math.min(MOST_BYTES, SRAM_END - stack - 1));
    const pc = this.#call("pc", index);
    const chip = {
      pc,
      function: this.array.functionAt(pc),
      code: hex(tile.readFlash(pc, CODE_BYTES)),
      registers: hex(tile.readMemory(0, REGISTERS)),
      sreg: this.#call("status", index),
      sp: stack,
      stack: hex(tile.readMemory(stack + 1, above)),
      cycles: tile.cycles.total,
      variables: this.#known().map(({ name, address, size }) =>
        [name, address, size, hex(tile.readMemory(address, Math.min(size, MOST_BYTES)))]),
    };
    return event(this.array.timeS, { port: portName(index), chip });
  }

  /** The image's variables in SRAM, in order of address. */
  #known() {
    if (this.#variables) return this.#variables;
    this.#variables = [];
    for (let address = SRAM_START; address < SRAM_END;) {
      const name = this.array.functionAt(DATA_SPACE + address);
      const { address: begin, size } = name ? this.array.symbol(name) : { address: DATA_SPACE + address, size: 1 };
      if (name && begin === DATA_SPACE + address) this.#variables.push({ name, address, size });
      address = Math.max(address + 1, begin - DATA_SPACE + size);
    }
    return this.#variables;
  }
}
