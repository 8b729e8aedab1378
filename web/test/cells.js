// Runs grids of cells as a test of both simulators has written down, and prints what comes out:
// node cells.js BUNDLE cells.json
import { readFile } from "node:fs/promises";
import { resolve } from "node:path";
import { argv, stdout } from "node:process";
import { pathToFileURL } from "node:url";

const [, , bundle, file] = argv;
/** @type {import("../src/index.js")} */
const { Simulator, tilesOf } = await import(`${pathToFileURL(resolve(bundle))}/index.js`);
const { model, drawings, steps, ...setup } = JSON.parse(await readFile(file, "utf8"));
const simulator = await Simulator.load();
const network = simulator.network(model);
const batch = simulator.batch(network, {
  ...setup,
  runs: setup.runs.map((/** @type {any} */ run, /** @type {number} */ number) => ({
    ...run,
    tiles: tilesOf(drawings[number]),
  })),
});
network.free(); // the batch has its own copy
const right = Array.from(batch.run(steps));
const { states, shown, updates } = batch;
stdout.write(JSON.stringify({ right, states: Array.from(states), shown: Array.from(shown), updates }));
