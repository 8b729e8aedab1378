// Prints how long a block of tiles takes under node, as JSON: node node.js BUNDLE CASE
import { readFile } from "node:fs/promises";
import { resolve } from "node:path";
import { argv, cpuUsage, stdout } from "node:process";
import { pathToFileURL } from "node:url";

import { runBlock } from "./block.js";

const [, , bundle, what] = argv;
const library = await import(`${pathToFileURL(resolve(bundle))}/index.js`);
const firmware = await readFile(`${bundle}/firmware.elf`);
let before = cpuUsage();
const wallS = await runBlock(library, firmware, JSON.parse(what), async () => {
  before = cpuUsage();
});
const { user, system } = cpuUsage(before);
stdout.write(`${JSON.stringify({ cpuS: (user + system) / 1e6, wallS })}\n`);
