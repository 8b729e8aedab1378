// The simulator: many grids of cells at once, by the firmware's own arithmetic, bit for bit.
import { GridBatch, SETUP } from "./batch.js";
import { whole } from "./checks.js";
import { Module, TilencaError } from "./module.js";
import { Structure } from "./structures.js";

const ABI_VERSION = 3; // TILENCA_SIMULATOR_ABI_VERSION
const NEIGHBOURHOOD = 5; // the own message, and those of N, E, S, W

const MODEL = new Structure({
  channels: "u8", hidden1: "u8", hidden2: "u8", classes: "u8",
  w1: "pointer", b1: "pointer", w2: "pointer", b2: "pointer", w3: "pointer", b3: "pointer",
});

/**
 * A trained network, as tools/release/web_model.py writes it.
 * @typedef {object} ModelFile
 * @property {number} channels
 * @property {number} hidden1
 * @property {number} hidden2
 * @property {string[]} labels of the classes
 * @property {Record<"w1" | "b1" | "w2" | "b2" | "w3" | "b3", string>} weights row by row, `w` as int8 and `b` as
 *   int16 with the low byte first, in base64
 */

/**
 * The bytes that base64 stands for; none if it is no base64.
 * @param {string} text
 */
function decoded(text) {
  try {
    return Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  } catch {
    return new Uint8Array();
  }
}

/** A network in the simulator's memory. */
export class Network {
  /** @type {number[]} */
  #pieces = [];

  /**
   * @param {Module} module
   * @param {ModelFile} file
   */
  constructor(module, file) {
    const { channels, hidden1, hidden2, labels, weights } = file;
    const counts = {
      w1: hidden1 * NEIGHBOURHOOD * channels, b1: hidden1, w2: hidden2 * hidden1, b2: hidden2,
      w3: channels * hidden2, b3: channels,
    };
    this.module = module;
    this.channels = channels;
    this.labels = labels;
    /** @type {Record<string, number>} */
    const members = { channels, hidden1, hidden2, classes: labels.length };
    for (const [name, count] of Object.entries(counts)) {
      const bytes = decoded(weights[/** @type {keyof counts} */ (name)]);
      const wanted = name.startsWith("w") ? count : 2 * count;
      if (bytes.length !== wanted) {
        this.free();
        throw new TilencaError(`${name} has ${bytes.length} bytes, and ${wanted} are needed`);
      }
      members[name] = this.#keep(wanted);
      module.bytes(members[name]).set(bytes);
    }
    this.address = this.#keep(MODEL.bytes);
    MODEL.write(module.bytes(this.address), members);
  }

  /** @param {number} bytes */
  #keep(bytes) {
    const address = this.module.allocate(bytes);
    this.#pieces.push(address);
    return address;
  }

  /** Batches that exist already have their own copy. */
  free() {
    for (const address of this.#pieces.splice(0)) {
      this.module.free(address);
    }
    this.address = 0;
  }
}

/** An instance of the simulator. */
export class Simulator {
  /** @param {Module} module */
  constructor(module) {
    this.module = module;
  }

  /** @param {import("./module.js").Source} [source] default: the module beside this file */
  static async load(source = new URL("./tilenca_simulator.wasm", import.meta.url)) {
    const structures = { tilenca_model: MODEL.bytes, tilenca_setup: SETUP.bytes };
    return new Simulator(await Module.load(source, "simulator", ABI_VERSION, structures));
  }

  /**
   * Puts a network into memory.
   * @param {ModelFile} file
   */
  network(file) {
    return new Network(this.module, file);
  }

  /**
   * Runs side by side.
   * @param {Network} network
   * @param {import("./batch.js").Setup} setup
   */
  batch(network, setup) {
    return new GridBatch(this.module, network, setup);
  }

  /**
   * One update of cells by themselves.
   * @param {Network} network
   * @param {Int16Array} states [cells][C], unit 2^-13
   * @param {Int8Array} inputs [cells][5 C], the message of the cell, then those of N, E, S, W
   * @param {number} [lanes] cells side by side: 0 as many as it can, 4, or 1 by the very code of the chip
   * @returns {Int16Array} the new states: a view, valid until the next call
   */
  updateCells(network, states, inputs, lanes = 0) {
    const cells = states.length / network.channels;
    if (!Number.isInteger(cells) || inputs.length !== NEIGHBOURHOOD * states.length) {
      throw new TilencaError(
        `${states.length} states and ${inputs.length} inputs; a cell has ${network.channels}, and 5 times as many`,
      );
    }
    this.module.begin(states.byteLength + inputs.byteLength + 32);
    const [to, from] = [this.module.take(states.byteLength), this.module.take(inputs.byteLength)];
    this.module.view(Int16Array, to, states.length).set(states);
    this.module.view(Int8Array, from, inputs.length).set(inputs);
    if (this.module.call("update_cells", network.address, to, from, cells, whole("the number of lanes", lanes)) !== 0) {
      throw new TilencaError(`${lanes} cells side by side cannot be computed here; 0 takes as many as can be`);
    }
    return this.module.view(Int16Array, to, states.length);
  }
}
