// The bundle that tests are about: what `make web` has built, or the folder that TILENCA_BUNDLE names.
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const folder = process.env.TILENCA_BUNDLE;
const address = new URL(folder === undefined ? "../../build/web/bundle/" : `${pathToFileURL(resolve(folder))}/`, import.meta.url);

/** @returns {Promise<typeof import("../src/index.js")>} */
async function load() {
  return import(new URL("index.js", address).href);
}

export const bundle = Object.assign(load, { address });
