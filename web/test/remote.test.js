// Arrays in workers: the same answers, frames while they play, and errors that come back.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";
import { Worker } from "node:worker_threads";

import { bundle } from "./bundle.js";

const { EAST, Emulator, RemoteArray, TilencaError, WEST } = await bundle();
const image = { name: "firmware.elf", bytes: await readFile(new URL("firmware.elf", bundle.address)) };
/** @type {import("../src/array.js").ArrayOptions} */
const options = { image, tiles: 2, links: [[0, EAST, 1, WEST]], ppm: [300, -300] };

test("an array in a worker does what one here does, to the byte", async () => {
  const remote = await RemoteArray.start(options);
  const here = (await Emulator.load()).array(options);
  assert.equal(remote.isTranslated, true);
  await remote.array("setFault", 0, EAST, { loss: 0.3 }, 5);
  here.setFault(0, EAST, { loss: 0.3 }, 5);
  await remote.array("run", 0.4);
  here.run(0.4);
  assert.equal(await remote.array("timeS"), here.timeS);
  assert.deepEqual(await remote.array("save"), here.save().slice());
  assert.equal(await remote.tile(1, "segments"), here.tile(1).segments);
  await remote.tile(1, "powered", false);
  assert.equal(await remote.tile(1, "powered"), false);
  assert.equal(await remote.array("addTile"), 2);
  remote.close();
});

test("a playing array shows frames, one after the other, and stands still after a pause", async () => {
  const remote = await RemoteArray.start(options);
  /** @type {import("../src/remote.js").Frame[]} */
  const frames = [];
  const played = new Promise((/** @type {(value?: unknown) => void} */ resolve) => {
    remote.onFrame = (frame) => {
      frames.push(frame);
      if (frames.length === 8) {
        resolve();
      }
    };
  });
  await remote.play();
  await played;
  await remote.pause();
  const last = frames[frames.length - 1];
  assert.equal(last.timeS, await remote.array("timeS"));
  assert.ok(frames.every((frame, place) => place === 0 || frame.timeS >= frames[place - 1].timeS));
  assert.equal(last.segments.length, 2);
  assert.equal(last.rgb.length, 6);
  assert.deepEqual(Array.from(last.powered), [1, 1]);
  remote.close();
});

test("play, pause and play at once leave one loop", async () => {
  const most = new Int32Array(new SharedArrayBuffer(4)); // timers that wait at the same time
  const counting = `
    const { workerData } = require("node:worker_threads");
    const [set, clear, waiting] = [setTimeout, clearTimeout, new Set()];
    globalThis.setTimeout = (call, ...more) => {
      const timer = set(() => { waiting.delete(timer); call(); }, ...more);
      workerData.most[0] = Math.max(workerData.most[0], waiting.add(timer).size);
      return timer;
    };
    globalThis.clearTimeout = (timer) => { waiting.delete(timer); clear(timer); };
    import(workerData.program);`;
  const program = new URL("worker.js", bundle.address).href;
  const worker = new Worker(counting, { eval: true, workerData: { most, program } });
  /** @type {(order: string, ...args: unknown[]) => Promise<unknown>} */
  const ask = (order, ...args) => {
    worker.postMessage({ id: order, order, args });
    return new Promise((resolve) => {
      worker.on("message", ({ id }) => id === order && resolve(id));
    });
  };
  await ask("build", options);
  await Promise.all(["play", "pause", "play", "pause", "play"].map((order) => ask(order, 1)));
  assert.equal(await ask("array", "timeS"), "array");
  assert.equal(most[0], 1);
  await worker.terminate();
});

test("orders without an answer are refused when the array is closed", async () => {
  const remote = await RemoteArray.start(options);
  const pending = remote.array("run", 0.1);
  remote.close();
  await assert.rejects(pending, /^TilencaError: the array is closed/);
  await assert.rejects(remote.array("timeS"), /the array is closed/);
});

test("a fault ends the play, and is told", async () => {
  const hex = { name: "astray.hex", bytes: new TextEncoder().encode(":020000000000FE\n:00000001FF\n") };
  const remote = await RemoteArray.start({ image: hex });
  const failure = new Promise((resolve) => {
    remote.onFailure = resolve;
  });
  await remote.play();
  assert.match(String(await failure), /^tile 1 stopped at 0x00002/);
  remote.close();
});

test("bad orders are errors", async () => {
  const bad = { name: "bad.elf", bytes: Uint8Array.of(1) };
  await assert.rejects(RemoteArray.start({ image: bad }), /bad.elf/);
  const remote = await RemoteArray.start(options);
  /** @type {any} */
  const [array, tile] = [remote.array.bind(remote), remote.tile.bind(remote)];
  for (const [asked, message] of [
    [array("run", -1), /a time to run is -1/],
    [array("constructor"), /cannot be asked of a worker/],
    [array("toString"), /cannot be asked of a worker/],
    [tile(7, "segments"), /tile 7 does not exist/],
    [tile(0, "tap", EAST), /cannot be asked of a worker/],
  ]) {
    await assert.rejects(asked, (error) => {
      assert.ok(error instanceof TilencaError);
      assert.match(error.message, message);
      return true;
    });
  }
  remote.close();
});
