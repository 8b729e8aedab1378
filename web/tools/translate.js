// Writes an image's most executed instructions as C++, for the compiler of the module itself:
// node translate.js interpreter.wasm firmware.elf blocks.cpp
//
// Only the module that will execute the blocks knows where the members of its core lie, so it counts, too.
import { readFile, writeFile } from "node:fs/promises";
import { basename } from "node:path";
import { argv, exit, stderr } from "node:process";
import { pathToFileURL } from "node:url";

import { EAST, NORTH, SOUTH, WEST } from "../src/sides.js";
import { Emulator } from "../src/emulator.js";

// What is counted: a block of tiles of this size, for so long. The shapes that matter are made of such blocks.
const ROWS = 3;
const COLUMNS = 3;
const COUNTED_S = 0.6;

/**
 * @param {string} interpreter the module without blocks
 * @param {string} image
 */
async function sourceOf(interpreter, image) {
  const emulator = await Emulator.load(pathToFileURL(interpreter));
  const places = Array.from({ length: ROWS * COLUMNS }, (_, place) => place);
  /** @type {import("../src/array.js").Link[]} */
  const links = [
    ...places.filter((i) => i % COLUMNS !== COLUMNS - 1).map((i) => /** @type {const} */ ([i, EAST, i + 1, WEST])),
    ...places.slice(0, -COLUMNS).map((i) => /** @type {const} */ ([i, SOUTH, i + COLUMNS, NORTH])),
  ];
  const array = emulator.array({
    image: { name: basename(image), bytes: await readFile(image) },
    tiles: places.length,
    links,
    ppm: places.map((i) => 700 * (i - Math.floor(places.length / 2))),
    translated: false,
  });
  array.countInstructions();
  array.run(COUNTED_S);
  return array.translated();
}

const [, , interpreter, image, blocks] = argv;
if (blocks === undefined) {
  stderr.write("usage: node translate.js interpreter.wasm firmware.elf blocks.cpp\n");
  exit(2);
}
try {
  await writeFile(blocks, await sourceOf(interpreter, image));
} catch (error) {
  stderr.write(`translate: ${error instanceof Error ? error.message : error}\n`);
  exit(1);
}
