// Gives the emulator's stream the commands of a file, and prints what it answers to each:
// node stream.js BUNDLE commands.json offer.json
import { readFile } from "node:fs/promises";
import { resolve } from "node:path";
import { argv } from "node:process";
import { pathToFileURL } from "node:url";

const [, , bundle, commands, offer] = argv;
const address = `${pathToFileURL(resolve(bundle))}/`;
/** @type {import("../src/stream/source.js")} */
const { EmulatedSource } = await import(`${address}stream/source.js`);
/** @type {import("../src/index.js")} */
const { Emulator, TilencaError } = await import(`${address}index.js`);

const image = { name: "firmware.elf", bytes: await readFile(new URL("firmware.elf", address)) };
const source = new EmulatedSource(
  await Emulator.load(), image, JSON.parse(await readFile(offer, "utf8")), () => performance.now() / 1000,
);
/** @type {import("../src/stream/source.js").StreamEvent[][]} */
const answers = [source.begin()];
for (const command of JSON.parse(await readFile(commands, "utf8"))) {
  try {
    source.take(command);
    answers.push(source.advance(0));
  } catch (error) {
    if (!(error instanceof TilencaError)) throw error;
    answers.push([{ time: 0, refused: error.message }, ...source.advance(0)]);
  }
}
process.stdout.write(JSON.stringify(answers));
