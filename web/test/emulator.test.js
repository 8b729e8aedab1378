// The emulator's face: what it shows, what it refuses, and that no view is mistaken for a copy.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";

import { bundle } from "./bundle.js";

const { EAST, Emulator, SOUTH, TilencaError, WEST, linksOf, tilesOf } = await bundle();
const firmware = { name: "firmware.elf", bytes: await readFile(new URL("firmware.elf", bundle.address)) };
const emulator = await Emulator.load();

/** @param {Partial<import("../src/array.js").ArrayOptions>} [options] */
const arrayOf = (options = {}) => emulator.array({ image: firmware, ...options });

test("tiles in the shape of a 4 show a 4", () => {
  const tiles = tilesOf("#.#\n#.#\n###\n..#\n..#");
  const array = arrayOf({ tiles: tiles.length, links: linksOf(tiles), ppm: tiles.map((_, tile) => 100 * tile) });
  array.run(1.0);
  const shown = tiles.map((_, tile) => array.tile(tile).segments);
  assert.deepEqual(shown, Array(tiles.length).fill(0x66));
  const { times, values } = array.tile(0).displayChanges();
  assert.equal(values.at(-1), 0x66);
  assert.ok(times.every((time, place) => time > 0 && time <= 1 && (place === 0 || time >= times[place - 1])));
  array.free();
});

test("a tile says on USB what it runs", () => {
  const array = arrayOf();
  array.run(0.5);
  assert.match(array.tile(0).readSerial(), /\$TILE,.*\*[0-9A-F]{2}\r?\n/);
  assert.equal(array.tile(0).readSerial(), "");
  array.free();
});

test("a snapshot brings the same future back, in another array, too", () => {
  const options = { tiles: 2, links: [/** @type {const} */ ([0, EAST, 1, WEST])], ppm: [900, -900] };
  const [one, other] = [arrayOf(options), arrayOf({ ...options, translated: false })];
  one.run(0.3);
  const before = one.save().slice();
  one.run(0.4);
  const after = one.save().slice();
  other.restore(before);
  other.run(0.4);
  assert.deepEqual(other.save().slice(), after);
  one.free();
  other.free();
});

test("a fault loses bytes, and counts them", () => {
  const array = arrayOf({ tiles: 2, links: [[0, EAST, 1, WEST]] });
  array.setFault(0, EAST, { loss: 0.5 }, 7n);
  array.run(1);
  const { bytes, lost, flipped } = array.faultCounts(0, EAST);
  assert.ok(lost > bytes / 4 && lost < (bytes * 3) / 4, `${lost} of ${bytes}`);
  assert.equal(flipped, 0);
  array.free();
});

test("a tile without power is dark, and starts anew with it", () => {
  const array = arrayOf();
  const tile = array.tile(0);
  array.run(0.3);
  assert.notEqual(tile.segments, 0);
  tile.powered = false;
  assert.equal(tile.powered, false);
  array.run(0.1);
  assert.equal(tile.segments, 0);
  tile.powered = true;
  array.run(0.3);
  assert.notEqual(tile.segments, 0);
  array.free();
});

test("a tap hears the bytes of a wire, and a probe the edges that spell them", () => {
  const array = arrayOf({ tiles: 2, links: [[0, EAST, 1, WEST]] });
  const heard = [array.tile(0).tap(EAST), array.tile(1).tap(WEST, { receiving: true })];
  array.run(0.2);
  const [sent, received] = heard.map((tap) => Array.from(tap.bytes().values));
  assert.ok(sent.length > 10);
  assert.deepEqual(received, sent.slice(0, received.length));
  assert.ok(received.length >= sent.length - 1);
  array.free();
});

test("memories read back what was written, as views of the module's own memory", () => {
  const array = arrayOf();
  const tile = array.tile(0);
  tile.writeEeprom(100, Uint8Array.of(1, 2, 3));
  const view = tile.readEeprom(99, 5);
  assert.deepEqual(Array.from(view), [255, 1, 2, 3, 255]);
  assert.equal(view.buffer, emulator.module.bytes(0).buffer);
  const { address, size } = array.symbol("timer0_millis");
  assert.equal(size, 4);
  array.run(0.1);
  const millis = tile.readMemory(address - 0x800000, size);
  assert.ok(millis[0] > 10 && millis[0] <= 100, `${millis}`);
  assert.equal(array.functionAt(array.symbol("main").address), "main");
  assert.equal(tile.readFlash(0, 2).length, 2);
  array.free();
});

test("bad calls are errors of one line, and change nothing", () => {
  const array = arrayOf({ tiles: 2, links: [[0, EAST, 1, WEST]] });
  const before = array.save().slice();
  /** @type {[() => unknown, RegExp][]} */
  const calls = [
    [() => array.tile(2), /tile 2 does not exist; there are 2/],
    [() => array.tile(-1), /tile -1 does not exist/],
    [() => array.tile(NaN), /tile NaN does not exist/],
    [() => array.tile(0.5), /tile 0.5 does not exist/],
    [() => array.run(-1), /a time to run is -1/],
    [() => array.run(NaN), /a time to run is nan/],
    [() => array.link(0, EAST, 1, WEST), /has a cable already/],
    [() => array.link(0, SOUTH, 0, WEST), /joins two tiles/],
    [() => array.link(0, 4, 1, WEST), /side 4 does not exist/],
    [() => array.unlink(0, SOUTH), /no cable at side 2 of tile 0/],
    [() => array.cut(0, SOUTH), /no cable at side 2 of tile 0/],
    [() => array.setFault(0, EAST, { loss: 2 }), /loss is 2/],
    [() => array.setFault(0, EAST, {}, 1.5), /the seed is 1.5; it must be a whole number/],
    [() => array.restore(before.slice(1)), /damaged, or no snapshot/],
    [() => array.restore(new Uint8Array()), /ends early/],
    [() => array.symbol("nosuch"), /has no symbol 'nosuch'/],
    [() => array.tile(0).pin("I", 0), /no port 'I'/],
    [() => array.tile(0).pin("B", 8), /pin of port B 8 does not exist/],
    [() => array.tile(0).setAnalog(16, 0), /analog input 16 does not exist/],
    [() => array.tile(0).setAnalog(0, 1024), /1024/],
    [() => array.tile(0).readEeprom(4095, 2), /./],
    [() => array.tile(0).writeEeprom(0.5, Uint8Array.of(1)), /the address is 0.5/],
    [() => array.translated(), /are not counted/],
    [() => arrayOf({ tiles: 0 }), /number of tiles is 0/],
    [() => arrayOf({ tiles: 1.5 }), /number of tiles is 1.5; it must be a whole number/],
    [() => arrayOf({ tiles: 2, ppm: [1] }), /2 tiles have 1 clock errors/],
    [() => arrayOf({ ppm: [NaN] }), /clock error in ppm is nan/],
    [() => arrayOf({ cableDelayS: 1 }), /cable's delay/],
    [() => arrayOf({ links: [[0, EAST, 1, WEST]] }), /tile 1 does not exist/],
    [() => emulator.array({ image: { name: "none.elf", bytes: new Uint8Array() } }), /none.elf: cannot be read, or empty/],
    [() => emulator.array({ image: { name: "bad.elf", bytes: Uint8Array.of(1, 2, 3) } }), /bad.elf/],
  ];
  for (const [call, message] of calls) {
    assert.throws(call, (error) => {
      assert.ok(error instanceof TilencaError, `${call}: ${error}`);
      assert.match(error.message, message);
      assert.doesNotMatch(error.message, /\n/);
      return true;
    });
  }
  assert.deepEqual(array.save().slice(), before);
  array.free();
  assert.throws(() => array.run(1), /the array is freed; build another/);
  array.free();
});

test("a program that goes astray ends the run with its tile, its place and the fact", () => {
  // 0x0000: NOP; the rest is erased.
  const hex = { name: "astray.hex", bytes: new TextEncoder().encode(":020000000000FE\n:00000001FF\n") };
  const array = emulator.array({ image: hex });
  assert.equal(array.isTranslated, false);
  assert.throws(() => array.run(0.1), /^TilencaError: tile 1 stopped at 0x00002: ran into erased flash/);
  assert.match(array.tile(0).fault, /erased flash/);
  array.free();
});

test("memory that grows leaves the tiles as they were", () => {
  const before = emulator.module.bytes(0).length;
  const arrays = Array.from({ length: 6 }, () => arrayOf({ tiles: 3 }));
  assert.ok(emulator.module.bytes(0).length > before);
  for (const array of arrays) {
    array.run(0.05);
  }
  const saved = arrays.map((array) => array.save().slice());
  assert.ok(saved.every((bytes) => Buffer.compare(bytes, saved[0]) === 0));
  for (const array of arrays) {
    array.free();
  }
});
