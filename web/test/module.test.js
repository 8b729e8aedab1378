// What is in the bundle: modules that import only what they are given, and the structures as this face has them.
import assert from "node:assert/strict";
import { readFile, readdir } from "node:fs/promises";
import { test } from "node:test";
import { gzipSync } from "node:zlib";

import { Module } from "../src/module.js";
import { Structure } from "../src/structures.js";
import { bundle } from "./bundle.js";

const { Emulator } = await bundle();
const MOST_BYTES = 1_000_000;
const MOST_GZIPPED = 400_000;

/** @param {string} name */
const bytesOf = (name) => readFile(new URL(name, bundle.address));

test("the modules import nothing but what module.js has", async () => {
  const own = ["files.read", "files.size", "env.emscripten_notify_memory_growth"];
  for (const name of ["tilenca_emulator.wasm", "tilenca_simulator.wasm"]) {
    const module = new WebAssembly.Module(/** @type {Uint8Array<ArrayBuffer>} */ (await bytesOf(name)));
    const imports = WebAssembly.Module.imports(module).map(({ module: from, name: what }) => `${from}.${what}`);
    assert.deepEqual(imports.filter((one) => !own.includes(one) && !one.startsWith("wasi_snapshot_preview1.")), []);
  }
});

test("every function of the C headers is there", async () => {
  for (const library of ["emulator", "simulator"]) {
    const header = new URL(`../../tools/${library}/include/tilenca/${library}.h`, import.meta.url);
    const declared = [...(await readFile(header, "utf8")).matchAll(/^TILENCA_API [^(]*?(\w+)\(/gm)].map(([, name]) => name);
    const module = new WebAssembly.Module(
      /** @type {Uint8Array<ArrayBuffer>} */ (await bytesOf(`tilenca_${library}.wasm`)),
    );
    const exported = new Set(WebAssembly.Module.exports(module).map(({ name }) => name));
    assert.ok(declared.length > 10);
    assert.deepEqual(declared.filter((name) => !exported.has(name)), []);
  }
});

test("what a page with emulated tiles loads is small", async () => {
  let [bytes, gzipped] = [0, 0];
  const files = (await readdir(bundle.address, { withFileTypes: true })).filter((one) => one.isFile()).map(({ name }) => name);
  for (const name of files.filter((file) => file !== "tilenca_simulator.wasm" && file !== "digits.json")) {
    const content = await bytesOf(name);
    bytes += content.length;
    gzipped += gzipSync(content, { level: 9 }).length;
  }
  assert.ok(bytes < MOST_BYTES, `${bytes} bytes`);
  assert.ok(gzipped < MOST_GZIPPED, `${gzipped} bytes gzipped`);
});

test("a library of another version, or with other structures, is refused", async () => {
  const address = new URL("tilenca_simulator.wasm", bundle.address);
  assert.ok(await Module.load(address, "simulator", 3, { tilenca_model: 28 }));
  await assert.rejects(Module.load(address, "simulator", 4, {}), /version 3, and this face is for 4/);
  await assert.rejects(Module.load(address, "simulator", 3, { tilenca_model: 32 }), /another tilenca_model/);
});

test("after a refused call for memory the next one has its room", async () => {
  const address = new URL("tilenca_simulator.wasm", bundle.address);
  const module = await Module.load(address, "simulator", 3, {});
  assert.throws(() => module.begin(0xffffff00), /out of memory/);
  module.begin(100);
  assert.notEqual(module.take(100), 0);
});

test("members of a structure lie where C puts them", () => {
  const memory = new Uint8Array(24);
  const structure = new Structure({ one: "u8", two: "u64", three: "u8", four: "i32" });
  assert.equal(structure.bytes, 24);
  structure.write(memory, { one: 1, two: 0x0203040506070809n, four: -2 });
  assert.deepEqual(Array.from(memory), [1, 0, 0, 0, 0, 0, 0, 0, 9, 8, 7, 6, 5, 4, 3, 2, 0, 0, 0, 0, 254, 255, 255, 255]);
});

test("what is no module, or another library's, is refused", async () => {
  const simulator = await bytesOf("tilenca_simulator.wasm");
  await assert.rejects(Emulator.load(new Uint8Array(8)), WebAssembly.CompileError);
  await assert.rejects(Emulator.load(new URL("none.wasm", bundle.address)), /none.wasm/);
  await assert.rejects(Emulator.load(/** @type {Uint8Array<ArrayBuffer>} */ (simulator)), /has no function abi_version/);
});
