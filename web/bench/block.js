// A block of tiles of the real firmware, run and timed: what node and the browser both do.

/**
 * @typedef {object} Case
 * @property {number} rows
 * @property {number} columns
 * @property {boolean} translated
 * @property {number} warmUpS emulated seconds before
 * @property {number} measuredS emulated seconds that are measured
 * @property {boolean} [worker] in a worker
 */

const PPM = 3000;
const SWITCHED_ON_S = 0.2;
const SLICE_S = 0.1; // a browser that heard nothing for long would offer to stop the page

/** @typedef {typeof import("../src/index.js")} Library */

/**
 * @param {Library} library
 * @param {Uint8Array} firmware
 * @param {Case} what
 * @returns {import("../src/array.js").ArrayOptions & { tiles: number }}
 */
function optionsOf({ linksOf, tilesOf }, firmware, what) {
  const tiles = tilesOf(Array(what.rows).fill("#".repeat(what.columns)).join("\n"));
  return {
    image: { name: "firmware.elf", bytes: firmware },
    tiles: tiles.length,
    links: linksOf(tiles),
    // Spread as chance would, and the same for whoever runs it.
    ppm: tiles.map((_, tile) => PPM * (((tile * 7) % tiles.length) / (tiles.length / 2) - 1)),
    switchOnS: tiles.map((_, tile) => (SWITCHED_ON_S * ((tile * 3) % tiles.length)) / tiles.length),
    translated: what.translated,
  };
}

/**
 * The same block in a worker: runs it, and lets it play for a few frames.
 * @param {Library} library
 * @param {Uint8Array} firmware
 * @param {Case} what
 * @returns {Promise<number>} wall seconds that the measured part took
 */
export async function runRemoteBlock(library, firmware, what) {
  const remote = await library.RemoteArray.start(optionsOf(library, firmware, what));
  await remote.array("run", what.warmUpS);
  const started = performance.now();
  await remote.array("run", what.measuredS);
  const spentMs = performance.now() - started;
  /** @type {import("../src/remote.js").Frame} */
  const frame = await new Promise((resolve) => {
    let frames = 0;
    remote.onFrame = (seen) => {
      frames++;
      if (frames === 5) {
        resolve(seen);
      }
    };
    remote.play();
  });
  await remote.pause();
  if (frame.timeS < what.warmUpS + what.measuredS || frame.segments.some((segments) => segments === 0)) {
    throw new Error(`a tile shows nothing, or the time is ${frame.timeS}`);
  }
  remote.close();
  return spentMs / 1000;
}

/**
 * @param {Library} library
 * @param {Uint8Array} firmware
 * @param {Case} what
 * @param {() => Promise<unknown>} begins called between warming up and measuring
 * @returns {Promise<number>} wall seconds that the measured part took
 */
export async function runBlock(library, firmware, what, begins) {
  const options = optionsOf(library, firmware, what);
  const emulator = await library.Emulator.load();
  const array = emulator.array(options);
  if (array.isTranslated !== what.translated) {
    throw new Error("the bundle has no blocks of this firmware; run `make web`");
  }
  array.run(what.warmUpS);
  await begins();
  let spentMs = 0;
  for (let slice = 0; slice < Math.round(what.measuredS / SLICE_S); slice++) {
    const started = performance.now();
    array.run(SLICE_S);
    spentMs += performance.now() - started;
    await new Promise((resolve) => setTimeout(resolve));
  }
  for (let tile = 0; tile < options.tiles; tile++) {
    if (array.tile(tile).segments === 0) {
      throw new Error(`tile ${tile} shows nothing`);
    }
  }
  return spentMs / 1000;
}
