// Eyes on an emulated tile's pins: edges, and the bytes that they spell.
import { pinOf } from "./checks.js";

const CHUNK = 4096;

/** Looks at a pin. Lists that it returns are views: they last until the next call. */
export class Probe {
  #number;

  /**
   * @param {import("./tile.js").Tile} tile
   * @param {string} port
   * @param {number} bit
   * @param {number} baud below 0: edges; 0: bytes at the rate of the pin's USART; above: bytes at that rate
   */
  constructor(tile, port, bit, baud) {
    this.array = tile.array;
    this.#number = this.#call("new", tile.index, ...pinOf(port, bit), baud);
  }

  /**
   * @param {string} name
   * @param {...number} args
   */
  #call(name, ...args) {
    return this.array.module.call(`probe_${name}`, this.array.handle, ...args);
  }

  /** The level before the first edge that was not taken yet. */
  get level() {
    return this.#call("level", this.#number) === 1;
  }

  /** The edges since the last call, at most 4096 at a time: when, and to which level. */
  edges() {
    const { module } = this.array;
    module.begin(9 * CHUNK + 32);
    const [times, levels] = [module.take(8 * CHUNK), module.take(CHUNK)];
    const count = this.#call("edges", this.#number, times, levels, CHUNK);
    return { times: module.view(Float64Array, times, count), levels: module.bytes(levels, count) };
  }

  /** The bytes since the last call, at most 4096 at a time: when, which, and whether the stop bit was low. */
  bytes() {
    const { module } = this.array;
    module.begin(10 * CHUNK + 48);
    const [times, values, errors] = [module.take(8 * CHUNK), module.take(CHUNK), module.take(CHUNK)];
    const count = this.#call("bytes", this.#number, times, values, errors, CHUNK);
    return {
      times: module.view(Float64Array, times, count),
      values: module.bytes(values, count),
      framingErrors: module.bytes(errors, count),
    };
  }

  /** Looks away; it costs nothing any more. */
  free() {
    this.#call("free", this.#number);
  }
}
