// Runs what a test of both emulators has written down, and writes the snapshot that it ends with:
// node scenario.js BUNDLE scenario.json snapshot
import { readFile, writeFile } from "node:fs/promises";
import { basename, resolve } from "node:path";
import { argv } from "node:process";
import { pathToFileURL } from "node:url";

/**
 * @typedef {object} Scenario
 * @property {string} image
 * @property {string} drawing
 * @property {number[]} ppm
 * @property {number[]} switchOnS
 * @property {number} seed
 * @property {boolean} translated
 * @property {[number, string, ...any[]][]} events at a time, what is done, and with what
 * @property {number} seconds
 */

const [, , bundle, file, snapshot] = argv;
/** @type {import("../src/index.js")} */
const { Emulator, linksOf, tilesOf } = await import(`${pathToFileURL(resolve(bundle))}/index.js`);
/** @type {Scenario} */
const scenario = JSON.parse(await readFile(file, "utf8"));
const tiles = tilesOf(scenario.drawing);
const emulator = await Emulator.load();
const array = emulator.array({
  image: { name: basename(scenario.image), bytes: await readFile(scenario.image) },
  tiles: tiles.length,
  links: linksOf(tiles),
  ppm: scenario.ppm,
  switchOnS: scenario.switchOnS,
  translated: scenario.translated,
});
if (array.isTranslated !== scenario.translated) {
  throw new Error("the module has no blocks of this image; build it for the image: make web");
}

/** @type {Record<string, (...args: any[]) => void>} */
const acts = {
  fault: (tile, side, fault) => array.setFault(tile, side, fault, scenario.seed),
  cut: (tile, side) => array.cut(tile, side),
  mend: (tile, side) => array.mend(tile, side),
  power: (tile, on) => {
    array.tile(tile).powered = on;
  },
  reset: (tile) => array.tile(tile).reset(),
  noise: (tile, deviation) => array.tile(tile).setAdcNoise(deviation, scenario.seed),
  drift: (tile, ppmPerS) => array.tile(tile).setDrift(ppmPerS),
  skew: (tile, ppm) => array.tile(tile).setSkew(ppm),
  send: (tile, text) => array.tile(tile).send(text),
  press: (tile, pressed) => array.tile(tile).pressButton(pressed),
};
for (const [timeS, act, ...args] of scenario.events) {
  array.run(Math.max(0, timeS - array.timeS));
  acts[act](...args);
}
array.run(scenario.seconds - array.timeS);
await writeFile(snapshot, array.save());
