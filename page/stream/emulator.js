// The source that is the emulator itself, in a worker of the page: it needs no server but one for files.

/** @import { Listener, Source } from "./source.js" */
import { Batches } from "./batches.js";
import { BROKE_OFF } from "./source.js";

/**
 * The emulator with the model of the page's address, or with its usual one.
 * @param {Listener} listener told of events once for every frame that the browser paints
 * @returns {Source}
 */
export function openEmulator(listener) {
  const address = new URL("../emulator/stream/worker.js", import.meta.url);
  const model = new URLSearchParams(location.search).get("model");
  if (model) address.searchParams.set("model", model);
  const worker = new Worker(address, { type: "module" });
  /** @type {Source["send"]} */
  const send = (command) => worker.postMessage(command);
  const batches = new Batches(listener.onEvents, send);
  worker.onmessage = ({ data }) => batches.take(data);
  worker.onerror = ({ message }) => {
    batches.take({ batch: 0, events: [{ time: 0, refused: `The emulator cannot run here: ${message || "its files are missing"}` }] });
    batches.paint();
    listener.onLost(0, BROKE_OFF);
  };
  return { send, close: () => worker.terminate() };
}
