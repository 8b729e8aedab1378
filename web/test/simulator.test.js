// The simulator's face: grids that agree, and calls that are refused.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";

import { bundle } from "./bundle.js";

const { Simulator, TilencaError, tilesOf } = await bundle();
const simulator = await Simulator.load();
/** @type {import("../src/simulator.js").ModelFile} */
const file = JSON.parse(await readFile(new URL("digits.json", bundle.address), "utf8"));
const four = tilesOf("#.#\n#.#\n###\n..#\n..#");
const target = file.labels.indexOf("4");

test("grids of a 4 come to show a 4, and every view is of the simulator's own memory", () => {
  const network = simulator.network(file);
  const batch = simulator.batch(network, { runs: [1, 2, 3].map((seed) => ({ tiles: four, target, seed })) });
  const right = batch.run(60);
  assert.equal(right.length, 3 * 60);
  assert.deepEqual(Array.from(right.slice(-3)), [1, 1, 1]);
  assert.ok(batch.shown.every((shown) => shown === target));
  assert.equal(batch.states.buffer, batch.shown.buffer);
  // Twice a step a random half of the cells updates.
  assert.ok(Math.abs(batch.updates / (3 * four.length * 60) - 1) < 0.05, `${batch.updates}`);
  batch.free();
  network.free();
});

test("the vectors compute what the chip's own code computes", () => {
  const network = simulator.network(file);
  const states = Int16Array.from({ length: 7 * file.channels }, (_, place) => ((place * 7919) % 16384) - 8192);
  const inputs = Int8Array.from({ length: 5 * states.length }, (_, place) => ((place * 31) % 255) - 127);
  const [chip, vectors] = [1, 4].map((lanes) => simulator.updateCells(network, states, inputs, lanes).slice());
  assert.deepEqual(vectors, chip);
  assert.notDeepEqual(chip, states);
  assert.deepEqual(simulator.updateCells(network, states, inputs).slice(), chip);
  network.free();
});

test("bad calls are errors of one line", () => {
  const network = simulator.network(file);
  const runs = [{ tiles: four, target, seed: 1 }];
  const batch = simulator.batch(network, { runs });
  /** @type {any} */
  const nonsense = "nonsense";
  const clocks = { first: [0], period: [1], latency: [0.5] };
  /** @type {[() => unknown, RegExp][]} */
  const calls = [
    [() => simulator.network({ ...file, weights: { ...file.weights, w1: "AAAA" } }), /w1 has 3 bytes/],
    [() => simulator.network({ ...file, weights: { ...file.weights, b2: "?" } }), /b2 has 0 bytes/],
    [() => simulator.batch(simulator.network({ ...file, labels: [] }), { runs }), /class 4 does not exist; there are 0/],
    [() => simulator.batch(network, { runs, loss: 2 }), /loss is 2/],
    [() => simulator.batch(network, { runs, loss: NaN }), /loss is NaN/],
    [() => simulator.batch(network, { runs, schedule: nonsense }), /no schedule 'nonsense'/],
    [() => simulator.batch(network, { runs, schedule: "clocks" }), /needs clocks/],
    [() => simulator.batch(network, { runs, schedule: "clocks", clocks }), /9 tiles have 1 first updates/],
    [() => simulator.batch(network, { runs: [{ ...runs[0], target: 99 }] }), /class 99 does not exist; there are 11/],
    [() => simulator.batch(network, { runs: [{ ...runs[0], seed: 0.5 }] }), /the seed is 0.5/],
    [() => simulator.batch(network, { runs: [{ ...runs[0], faulty: 99 }], fault: "dead" }), /tile 99 does not exist; there are 9/],
    [() => batch.run(-1), /-1/],
    [() => batch.run(0.5), /steps is 0.5; it must be a whole number/],
    [() => simulator.updateCells(network, new Int16Array(1), new Int8Array(5)), /1 states and 5 inputs/],
    [() => simulator.updateCells(network, new Int16Array(file.channels), new Int8Array(5 * file.channels), 8), /8 cells/],
    [() => tilesOf("#x"), /a drawing has 'x'/],
  ];
  for (const [call, message] of calls) {
    assert.throws(call, (error) => {
      assert.ok(error instanceof TilencaError, `${call}: ${error}`);
      assert.match(error.message, message);
      return true;
    });
  }
  batch.free();
  assert.throws(() => batch.run(1), /the batch is freed/);
  network.free();
});
