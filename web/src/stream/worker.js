// A worker that speaks as the WebSocket of `tilenca page` does (docs/PROTOCOL.md section 7): commands in, batches of
// events out. The folder above this one has the module, the firmware and the offer.
import { Emulator } from "../emulator.js";
import { TilencaError } from "../module.js";
import { EmulatedSource } from "./source.js";
import { refused } from "./teller.js";

const TICK_MS = 1000 / 60;
// A run that was held up does not catch up with more than this.
const MOST_TICK_S = 0.1;
// Batches that may be on their way, unseen; while there are more, time stands still.
const MOST_UNSEEN = 3;

/** @typedef {import("./source.js").StreamEvent} StreamEvent */

/** @param {string} name of a file of the bundle */
async function fetched(name) {
  const response = await fetch(new URL(`../${name}`, import.meta.url));
  if (!response.ok) throw new TilencaError(`${name}: ${response.status} ${response.statusText}; serve the whole bundle`);
  return response;
}

/** What there is to see of the model that the worker's address asks for by name or id, and its firmware. */
async function chosen() {
  const wanted = new URL(import.meta.url).searchParams.get("model") ?? "";
  const usual = wanted ? null : fetched("firmware.elf"); // at once: most pages want this one
  usual?.catch(() => {}); // it is told where it is awaited
  /** @type {import("./source.js").Offer} */
  const first = await (await fetched("offer.json")).json();
  const models = first.stream.models ?? [];
  const name = models.find((model) => wanted && [model.name, model.id].includes(wanted))?.name ?? first.stream.model;
  if (name === first.stream.model) return { offer: first, image: await (await (usual ?? fetched("firmware.elf"))).arrayBuffer() };
  const path = `models/${encodeURIComponent(name ?? "")}`;
  const [offer, image] = await Promise.all([fetched(`${path}.json`), fetched(`${path}.elf`)]);
  return { offer: /** @type {import("./source.js").Offer} */ (await offer.json()), image: await image.arrayBuffer() };
}

async function ready() {
  const [emulator, { offer, image }] = await Promise.all([Emulator.load(), chosen()]);
  const firmware = { name: "firmware.elf", bytes: new Uint8Array(image) };
  return new EmulatedSource(emulator, firmware, offer, () => performance.now() / 1000);
}

/** @param {unknown} error @returns {StreamEvent} */
function refusal(error) {
  const words = error instanceof TilencaError ? error.message : `the run broke off: ${error}`;
  return refused(words);
}

/** Runs the source for as long as the page is there. */
class Session {
  #sent = 0;
  #seen = 0;
  #beforeMs = performance.now();
  /** Of the next turn. @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;

  /** @param {EmulatedSource} source */
  constructor(source) {
    this.source = source;
    this.#deliver(source.begin());
    this.#turn();
  }

  /** @param {import("./commands.js").Command} command */
  take(command) {
    if (command.do === "seen") {
      this.#seen = Math.max(this.#seen, Math.min(Number(command.batch), this.#sent));
    } else {
      this.#attempt(() => this.source.take(command));
    }
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#turn(), 0);
  }

  #turn() {
    clearTimeout(this.#timer);
    const nowMs = performance.now();
    const dueMs = this.#beforeMs + TICK_MS - nowMs;
    if (dueMs > 1 && !this.source.isIdle) {
      this.#timer = setTimeout(() => this.#turn(), dueMs);
      return;
    }
    if (this.#sent - this.#seen >= MOST_UNSEEN) return; // `seen` wakes it
    const tickS = Math.min((nowMs - this.#beforeMs) / 1000, MOST_TICK_S);
    this.#beforeMs = nowMs;
    this.#attempt(() => this.#deliver(this.source.advance(tickS)));
    if (!this.source.isIdle) this.#timer = setTimeout(() => this.#turn(), this.#beforeMs + TICK_MS - performance.now());
  }

  /** @param {() => void} act */
  #attempt(act) {
    try {
      act();
    } catch (error) {
      this.#deliver([refusal(error)]);
    }
  }

  /** @param {StreamEvent[]} events */
  #deliver(events) {
    if (events.length > 0) self.postMessage({ batch: ++this.#sent, events });
  }
}

const session = ready().then((source) => new Session(source));
session.catch((error) => self.postMessage({ batch: 0, events: [refusal(error)] }));
self.onmessage = ({ data }) => void session.then((running) => running.take(data), () => {});
