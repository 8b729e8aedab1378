// A block of tiles of the real firmware, run and timed: what node and the browser both do.

/**
 * @typedef {object} Case
 * @property {number} rows
 * @property {number} columns
 * @property {boolean} translated
 * @property {number} warmUpS emulated seconds before
 * @property {number} measuredS emulated seconds that are measured
 */

const PPM = 3000;
const SWITCHED_ON_S = 0.2;
const SLICE_S = 0.1; // a browser that heard nothing for long would offer to stop the page

/**
 * @param {typeof import("../src/index.js")} library
 * @param {Uint8Array} firmware
 * @param {Case} what
 * @param {() => Promise<void>} begins called between warming up and measuring
 * @returns {Promise<number>} wall seconds that the measured part took
 */
export async function runBlock({ Emulator, linksOf, tilesOf }, firmware, what, begins) {
  const tiles = tilesOf(Array(what.rows).fill("#".repeat(what.columns)).join("\n"));
  const emulator = await Emulator.load();
  const array = emulator.array({
    image: { name: "firmware.elf", bytes: firmware },
    tiles: tiles.length,
    links: linksOf(tiles),
    // Spread as chance would, and the same for whoever runs it.
    ppm: tiles.map((_, tile) => PPM * (((tile * 7) % tiles.length) / (tiles.length / 2) - 1)),
    switchOnS: tiles.map((_, tile) => (SWITCHED_ON_S * ((tile * 3) % tiles.length)) / tiles.length),
    translated: what.translated,
  });
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
  if (tiles.some((_, tile) => array.tile(tile).segments === 0)) {
    throw new Error("a tile shows nothing");
  }
  return spentMs / 1000;
}
