// An array in a worker of its own: obeys a RemoteArray, runs in step with the wall clock, and shows what eyes see.
import { TileArray } from "./array.js";
import { Emulator } from "./emulator.js";
import { TilencaError } from "./module.js";
import { ownPort } from "./port.js";
import { Tile } from "./tile.js";

const LONGEST_STEP_S = 0.05; // emulated at a time, so that orders do not wait
const MOST_BEHIND_S = 0.25; // beyond that the emulated time waits for no wall clock
const FRAME_MS = 1000 / 60;

/** @typedef {import("./remote.js").Frame} Frame */

const port = await ownPort();
/** @type {TileArray | undefined} */
let array;
/** What the clock on the wall said when the emulated time was how much; undefined: it stands. */
/** @type {{ wallMs: number, timeS: number, pace: number, behindS: number } | undefined} */
let clock;
/** Of the next turn. @type {ReturnType<typeof setTimeout> | undefined} */
let timer;
let shownMs = 0;

function ready() {
  if (array === undefined) {
    throw new TilencaError("the array is not built yet");
  }
  return array;
}

/**
 * Copies of views, which may leave this worker.
 * @param {unknown} result
 * @returns {unknown}
 */
function outward(result) {
  if (ArrayBuffer.isView(result)) {
    return /** @type {Uint8Array} */ (result).slice();
  }
  if (result instanceof Tile) {
    return result.index;
  }
  if (typeof result === "object" && result !== null && Object.getPrototypeOf(result) === Object.prototype) {
    return Object.fromEntries(Object.entries(result).map(([name, value]) => [name, outward(value)]));
  }
  return result;
}

/**
 * Calls a method, or reads or sets a property, that the class has for everybody.
 * @param {TileArray | Tile} target
 * @param {string} name
 * @param {unknown[]} args
 */
function perform(target, name, args) {
  const member = Object.getOwnPropertyDescriptor(Object.getPrototypeOf(target), name);
  if (member === undefined || name === "constructor" || name === "probe" || name === "tap") {
    throw new TilencaError(`'${name}' cannot be asked of a worker`);
  }
  if (typeof member.value === "function") {
    return member.value.apply(target, args);
  }
  return args.length === 0 ? member.get?.call(target) : member.set?.call(target, args[0]);
}

function show() {
  const { size, timeS } = ready();
  /** @type {Frame} */
  const frame = {
    timeS, behindS: clock?.behindS ?? 0, segments: new Uint8Array(size), leds: new Uint8Array(size),
    rgb: new Uint8Array(3 * size), powered: new Uint8Array(size), serial: [],
  };
  for (let index = 0; index < size; index++) {
    const tile = ready().tile(index);
    frame.segments[index] = tile.segments;
    frame.leds[index] = tile.leds;
    frame.rgb.set(tile.rgb, 3 * index);
    frame.powered[index] = Number(tile.powered);
    frame.serial.push(tile.readSerial());
  }
  const buffers = [frame.segments, frame.leds, frame.rgb, frame.powered].map(({ buffer }) => buffer);
  port.post({ frame }, buffers);
}

function turn() {
  if (clock === undefined) {
    return;
  }
  const nowMs = performance.now();
  const due = clock.timeS + ((nowMs - clock.wallMs) / 1000) * clock.pace;
  const late = due - ready().timeS;
  try {
    ready().run(Math.min(Math.max(0, late), LONGEST_STEP_S));
  } catch (error) {
    clock = undefined;
    show();
    port.post({ failure: error instanceof Error ? error.message : String(error) });
    return;
  }
  if (late > MOST_BEHIND_S) {
    clock.behindS += late - MOST_BEHIND_S;
    clock.timeS -= late - MOST_BEHIND_S;
  }
  if (nowMs - shownMs >= FRAME_MS) {
    shownMs = nowMs;
    show();
  }
  timer = setTimeout(turn, late > LONGEST_STEP_S ? 0 : 4);
}

/** @type {Record<string, (...args: any[]) => unknown>} */
const orders = {
  build: async (options) => {
    array = (await Emulator.load(options.source)).array(options);
    return array.isTranslated;
  },
  array: (name, ...args) => perform(ready(), name, args),
  tile: (index, name, ...args) => perform(ready().tile(index), name, args),
  play: (pace) => {
    clock = { wallMs: performance.now(), timeS: ready().timeS, pace, behindS: 0 };
    clearTimeout(timer); // one loop, however often somebody plays
    turn();
  },
  pause: () => {
    clock = undefined;
    clearTimeout(timer);
    show();
  },
};

port.listen(async ({ id, order, args }) => {
  try {
    port.post({ id, result: outward(await orders[order](...args)) });
  } catch (error) {
    port.post({ id, error: error instanceof Error ? error.message : String(error) });
  }
}, () => {});
