// An array that runs in a worker, so that the page stays alive: the end that the page has.
import { TilencaError } from "./module.js";
import { startWorker } from "./port.js";

const CLOSED = "the array is closed; start another";

/**
 * What eyes see of all tiles at a moment.
 * @typedef {object} Frame
 * @property {number} timeS emulated seconds since the array began
 * @property {number} behindS seconds by which it has fallen behind the wall clock since `play`
 * @property {Uint8Array<ArrayBuffer>} segments of each tile, as `Tile.segments`
 * @property {Uint8Array<ArrayBuffer>} leds of each tile, as `Tile.leds`
 * @property {Uint8Array<ArrayBuffer>} rgb three of each tile
 * @property {Uint8Array<ArrayBuffer>} powered 1 or 0 of each tile
 * @property {string[]} serial what each tile has said on USB since the last frame
 */

/** @typedef {{ resolve: (value: any) => void, reject: (error: Error) => void }} Waiting */

/** An array in a worker. Its orders are done in the order in which they are given. */
export class RemoteArray {
  /** @type {Map<number, Waiting>} */
  #waiting = new Map();
  #last = 0;
  #isClosed = false;
  /** Called about sixty times a second while the array plays.
   * @type {(frame: Frame) => void} */
  onFrame = () => {};
  /** Called when a tile has stopped at a fault, which ends the play.
   * @type {(message: string) => void} */
  onFailure = () => {};
  /** Whether the tiles execute translated blocks. */
  isTranslated = false;

  /** @param {import("./port.js").Port} port */
  constructor(port) {
    this.port = port;
    port.listen(
      (message) => this.#hear(message),
      (error) => this.#giveUp(error),
    );
  }

  /**
   * Builds an array in a worker of its own.
   * @param {import("./array.js").ArrayOptions & { source?: string }} options `source`: the address of the module,
   *   default: beside this file
   */
  static async start(options) {
    const remote = new RemoteArray(await startWorker(new URL("./worker.js", import.meta.url)));
    try {
      remote.isTranslated = await remote.#order("build", options);
    } catch (error) {
      remote.close();
      throw error;
    }
    return remote;
  }

  /** @param {any} message */
  #hear({ frame, failure, id, result, error }) {
    if (frame !== undefined) {
      this.onFrame(frame);
    } else if (failure !== undefined) {
      this.onFailure(failure);
    } else {
      const waiting = this.#waiting.get(id);
      this.#waiting.delete(id);
      if (error === undefined) {
        waiting?.resolve(result);
      } else {
        waiting?.reject(new TilencaError(error));
      }
    }
  }

  /**
   * @param {string} order
   * @param {...unknown} args
   * @returns {Promise<any>}
   */
  #order(order, ...args) {
    if (this.#isClosed) {
      return Promise.reject(new TilencaError(CLOSED));
    }
    const id = ++this.#last;
    return new Promise((resolve, reject) => {
      this.#waiting.set(id, { resolve, reject });
      this.port.post({ id, order, args });
    });
  }

  /**
   * Calls a method of the array, or reads a property: `array("cut", 3, EAST)`, `array("timeS")`.
   * @param {keyof import("./array.js").TileArray} name
   * @param {...unknown} args
   * @returns {Promise<any>} lists are copies
   */
  array(name, ...args) {
    return this.#order("array", name, ...args);
  }

  /**
   * Calls a method of a tile, or reads a property, or sets one: `tile(3, "powered", false)`.
   * @param {number} index
   * @param {keyof import("./tile.js").Tile} name
   * @param {...unknown} args
   * @returns {Promise<any>} lists are copies
   */
  tile(index, name, ...args) {
    return this.#order("tile", index, name, ...args);
  }

  /**
   * Runs in step with the wall clock from now on.
   * @param {number} [pace] emulated seconds in a second
   * @returns {Promise<void>}
   */
  play(pace = 1) {
    return this.#order("play", pace);
  }

  /**
   * Stands still, and shows a last frame.
   * @returns {Promise<void>}
   */
  pause() {
    return this.#order("pause");
  }

  /** Ends the worker; orders that have no answer yet, and later ones, are refused. */
  close() {
    this.#isClosed = true;
    this.port.close();
    this.#giveUp(new TilencaError(CLOSED));
  }

  /** @param {Error} error */
  #giveUp(error) {
    for (const { reject } of this.#waiting.values()) {
      reject(error);
    }
    this.#waiting.clear();
  }
}
