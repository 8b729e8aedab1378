// Runs of the simulator side by side, each one grid of cells with its own chance.
import { forEach, indexBelow, seedOf, whole } from "./checks.js";
import { neighboursOf } from "./drawing.js";
import { TilencaError } from "./module.js";
import { Structure } from "./structures.js";

export const SETUP = new Structure({
  runs: "i32", cells: "i32", starts: "pointer", neighbours: "pointer", alive: "pointer", target: "pointer",
  seeds: "pointer", loss: "u64", zeros: "u8", schedule: "u8", running: "u8", start: "i64", first: "pointer",
  period: "pointer", latency: "pointer", seed_latency: "pointer", line: "pointer", fault: "u8", faulty: "pointer",
  begin: "i64", end: "i64", changes: "pointer", changes_count: "i32",
});
const SCHEDULES = ["halves", "clocks", "listing"];
const FAULTS = ["none", "dead", "stuck", "away"];
const TICKS = 20;
const UNITS_PER_TICK = 65536;
const UNITS_PER_STEP = TICKS * UNITS_PER_TICK;
const SIDES = 4;
const DARK = -1;
const SEED_STATE = 8192; // 1.0 in units of 2^-13

/**
 * One run: its grid, the class that is right there, and its own chance.
 * @typedef {object} Run
 * @property {readonly import("./drawing.js").Place[]} tiles of `tilesOf`
 * @property {number} target the number of the class
 * @property {number | bigint} seed
 * @property {number} [faulty] the tile with the fault; default: none
 */

/**
 * Tiles' clocks, in steps; one of each for every cell of all runs.
 * @typedef {object} Clocks
 * @property {ArrayLike<number>} first when each updates for the first time, from 0
 * @property {ArrayLike<number>} period about 1
 * @property {ArrayLike<number>} latency of messages to all sides, below the period
 */

/**
 * @typedef {object} Setup
 * @property {readonly Run[]} runs
 * @property {"halves" | "clocks" | "listing"} [schedule] default: halves, a random half of the cells twice a step
 * @property {Clocks} [clocks] for the schedule of that name
 * @property {number} [loss] share of the messages that are lost, 0 to 1
 * @property {boolean} [zeros] a lost message reads as zeros; default: the last one is held
 * @property {"none" | "dead" | "stuck" | "away"} [fault] of the runs' faulty tiles
 * @property {number} [begin] the first step of the fault
 * @property {number} [end] the step at which a tile that was away is back
 */

/**
 * States of cells that were just switched on.
 * @param {number} cells
 * @param {number} channels
 */
export function seedStates(cells, channels) {
  return Int16Array.from({ length: cells * channels }, (_, place) => (place % channels === 0 ? SEED_STATE : 0));
}

/** Runs side by side, made by `Simulator.batch`. `states` and `shown` are views of the simulator's own numbers. */
export class GridBatch {
  #handle = 0;
  /** @type {number[]} */
  #pieces = [];
  #states = 0;
  #shown = 0;
  #results = 0;

  /**
   * @param {import("./module.js").Module} module
   * @param {import("./simulator.js").Network} network
   * @param {Setup} setup
   */
  constructor(module, network, setup) {
    this.module = module;
    this.channels = network.channels;
    this.runs = setup.runs.length;
    this.cells = setup.runs.reduce((sum, run) => sum + run.tiles.length, 0);
    try {
      this.#states = this.#room(Int16Array, this.cells * this.channels);
      this.#shown = this.#room(Int8Array, this.cells);
      this.states.set(seedStates(this.cells, this.channels));
      this.shown.fill(DARK);
      const address = this.#room(Uint8Array, SETUP.bytes);
      const members = { ...this.#grids(setup.runs, network.labels.length), ...this.#conditions(setup) };
      SETUP.write(module.bytes(address), members);
      this.#handle = module.address("grid_batch_new", network.address, address, this.#states, this.#shown);
    } catch (error) {
      this.free();
      throw error;
    }
  }

  /**
   * @param {readonly Run[]} runs
   * @param {number} classes
   */
  #grids(runs, classes) {
    const starts = [0];
    for (const { tiles } of runs) {
      starts.push(starts[starts.length - 1] + tiles.length);
    }
    const neighbours = runs.flatMap(({ tiles }, run) =>
      neighboursOf(tiles).flatMap((sides) => sides.map((one) => (one < 0 ? this.cells : starts[run] + one))),
    );
    return {
      runs: runs.length,
      cells: this.cells,
      starts: this.#list(Int32Array, starts),
      neighbours: this.#list(Int32Array, neighbours),
      alive: this.#list(Uint8Array, Array(this.cells).fill(1)),
      target: this.#list(
        Int8Array,
        runs.flatMap(({ tiles, target }) => Array(tiles.length).fill(indexBelow("class", target, classes))),
      ),
      seeds: this.#list(BigUint64Array, runs.map(({ seed }) => seedOf(seed))),
      faulty: this.#list(
        Int32Array,
        runs.map(({ faulty, tiles }, run) =>
          faulty === undefined ? -1 : starts[run] + indexBelow("tile", faulty, tiles.length),
        ),
      ),
    };
  }

  /** @param {Setup} setup */
  #conditions({ schedule = "halves", clocks, loss = 0, zeros = false, fault = "none", begin = 0, end = 0 }) {
    if (!(loss >= 0 && loss <= 1)) {
      throw new TilencaError(`loss is ${loss}; it must be 0 to 1`);
    }
    const [number, kind] = [SCHEDULES.indexOf(schedule), FAULTS.indexOf(fault)];
    if (number < 0 || kind < 0) {
      throw new TilencaError(`no schedule '${schedule}', or no fault '${fault}'`);
    }
    if (schedule === "clocks" && clocks === undefined) {
      throw new TilencaError("the schedule 'clocks' needs clocks");
    }
    const given = clocks ?? { first: undefined, period: undefined, latency: undefined };
    const first = forEach("first updates", given.first, this.cells, 0);
    const earliest = Math.min(0, ...first.map((step, cell) => step - (given.period?.[cell] ?? 1)));
    return {
      loss: BigInt(Math.round(loss * 2 ** 32)),
      zeros: Number(zeros),
      schedule: number,
      start: BigInt(Math.floor(earliest * TICKS) * UNITS_PER_TICK),
      first: this.#times(first),
      period: this.#times(forEach("periods", given.period, this.cells, 1)),
      latency: this.#times(forEach("latencies", given.latency, this.cells, 0.5), SIDES),
      seed_latency: 0, // as the others
      line: 0, // of no length
      fault: kind,
      begin: whole("the fault's begin", begin),
      end: whole("the fault's end", end),
    };
  }

  /**
   * @param {Float64Array} steps
   * @param {number} [times] how often each is listed
   */
  #times(steps, times = 1) {
    const units = Array.from(steps, (step) => BigInt(Math.round(step * UNITS_PER_STEP)));
    return this.#list(BigInt64Array, units.flatMap((unit) => Array(times).fill(unit)));
  }

  /**
   * @template {number | bigint} N
   * @param {{ new (buffer: ArrayBufferLike, address: number, length: number): { set(numbers: ArrayLike<N>): void },
   *   BYTES_PER_ELEMENT: number }} kind
   * @param {N[]} numbers
   */
  #list(kind, numbers) {
    const address = this.#room(kind, numbers.length);
    new kind(this.module.bytes(0).buffer, address, numbers.length).set(numbers);
    return address;
  }

  /**
   * @param {{ BYTES_PER_ELEMENT: number }} kind
   * @param {number} count
   */
  #room(kind, count) {
    const address = this.module.allocate(count * kind.BYTES_PER_ELEMENT);
    this.#pieces.push(address);
    return address;
  }

  /** States [cells][C], unit 2^-13: a view, valid until the next call. */
  get states() {
    return this.module.view(Int16Array, this.#states, this.cells * this.channels);
  }

  /** The class that each tile shows, -1 for a dark one: a view, valid until the next call. */
  get shown() {
    return this.module.view(Int8Array, this.#shown, this.cells);
  }

  /** How many cell updates were computed in all. */
  get updates() {
    return Number(this.module.call("grid_batch_updates", this.handle));
  }

  /** The batch as the C interface knows it. */
  get handle() {
    if (this.#handle === 0) {
      throw new TilencaError("the batch is freed; make another");
    }
    return this.#handle;
  }

  /**
   * Goes on for some steps.
   * @param {number} steps
   * @returns {Float32Array} [steps][runs] the share of tiles that are right: a view, valid until the next call
   */
  run(steps) {
    const count = Math.max(0, whole("the number of steps", steps)) * this.runs;
    this.module.free(this.#results);
    this.#results = 0;
    this.#results = this.module.allocate(4 * count);
    this.module.call("grid_batch_run", this.handle, steps, 1, this.#results, 0);
    return this.module.view(Float32Array, this.#results, count);
  }

  /** Frees it; it cannot be used afterwards. */
  free() {
    if (this.#handle !== 0) {
      this.module.call("grid_batch_free", this.#handle);
      this.#handle = 0;
    }
    for (const address of this.#pieces.splice(0)) {
      this.module.free(address);
    }
    this.module.free(this.#results);
    this.#results = 0;
  }
}
