// Workers of browsers and those of node, which differ in how one listens.

/**
 * One end of the connection to a worker.
 * @typedef {object} Port
 * @property {(message: any, transfer?: ArrayBuffer[]) => void} post
 * @property {(hear: (message: any) => void, fail: (error: Error) => void) => void} listen
 * @property {() => void} close
 */

const IS_NODE = typeof process === "object" && process.versions?.node !== undefined;

/**
 * Starts a worker.
 * @param {URL} program
 * @returns {Promise<Port>}
 */
export async function startWorker(program) {
  if (IS_NODE) {
    const { Worker } = await import("node:worker_threads");
    const worker = new Worker(program);
    return {
      post: (message, transfer) => worker.postMessage(message, transfer),
      listen: (hear, fail) => {
        worker.on("message", hear);
        worker.on("error", fail);
      },
      close: () => void worker.terminate(),
    };
  }
  const worker = new Worker(program, { type: "module" });
  return {
    post: (message, transfer = []) => worker.postMessage(message, transfer),
    listen: (hear, fail) => {
      worker.onmessage = ({ data }) => hear(data);
      worker.onerror = ({ message }) => fail(new Error(message));
    },
    close: () => worker.terminate(),
  };
}

/**
 * The end that a worker itself has.
 * @returns {Promise<Port>}
 */
export async function ownPort() {
  if (IS_NODE) {
    const { parentPort } = await import("node:worker_threads");
    if (parentPort === null) {
      throw new Error("this program is for a worker");
    }
    return {
      post: (message, transfer) => parentPort.postMessage(message, transfer),
      listen: (hear) => void parentPort.on("message", hear),
      close: () => parentPort.close(),
    };
  }
  return {
    post: (message, transfer = []) => self.postMessage(message, { transfer }),
    listen: (hear) => {
      self.onmessage = ({ data }) => hear(data);
    },
    close: () => self.close(),
  };
}
