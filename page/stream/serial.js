// The seam to Web Serial: a port of bytes, which the browser lends to the page.

/**
 * As much of Web Serial as is used here; the checker of types does not know it.
 * @typedef {{
 *   open: (options: {baudRate: number, bufferSize?: number}) => Promise<void>,
 *   close: () => Promise<void>,
 *   setSignals: (signals: {dataTerminalReady?: boolean, requestToSend?: boolean}) => Promise<void>,
 *   readable: ReadableStream<Uint8Array> | null,
 *   writable: WritableStream<Uint8Array> | null,
 *   getInfo: () => {usbVendorId?: number, usbProductId?: number},
 *   connected?: boolean,
 * }} WebPort
 * @typedef {EventTarget & {
 *   getPorts: () => Promise<WebPort[]>,
 *   requestPort: (options?: {filters: {usbVendorId: number}[]}) => Promise<WebPort>,
 * }} WebSerial
 */

/** Of telemetry and of the stock bootloader. */
const BAUD = 115200;
const BUFFER_BYTES = 16384;
const WRITE_MS = 5000;
/** A board resets when DTR goes low; its chip starts within 65 ms. */
const HELD_MS = 250;
const START_MS = 100;

/** The port is not there any more. */
export class GoneError extends Error {}

/** The browser's serial ports; null where it has none, or the page came from elsewhere without encryption. @returns {WebSerial | null} */
export function webSerial() {
  return /** @type {any} */ (navigator).serial ?? null;
}

/** @param {number} ms @returns {Promise<void>} */
export const passed = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** One port. */
export class BytePort {
  /** @type {number[]} */
  #heard = [];
  #wake = () => {};
  #isLost = false;
  #isClosing = false;
  /** @type {ReadableStreamDefaultReader<Uint8Array> | null} */
  #reader = null;
  #pump = Promise.resolve();
  /** Until then somebody writes. @type {Promise<unknown>} */
  #writing = Promise.resolve();

  /** @param {WebPort} port */
  constructor(port) {
    this.port = port;
  }

  /** Opens it, which may reset the board. */
  async open() {
    await this.port.open({ baudRate: BAUD, bufferSize: BUFFER_BYTES });
    this.#heard = [];
    this.#isLost = this.#isClosing = false;
    this.#pump = this.#listen();
  }

  async #listen() {
    let isOver = false;
    while (this.port.readable && !isOver) {
      const reader = this.port.readable.getReader();
      this.#reader = reader;
      try {
        while (!isOver) {
          const { value, done } = await reader.read();
          if (value) this.#heard.push(...value);
          isOver = done;
          this.#wake();
        }
      } catch {
        // After a damaged byte the port has another stream; a board that has gone has none.
      }
      reader.releaseLock();
    }
    this.#isLost = true;
    this.#wake();
  }

  /**
   * What has come; waits where nothing has.
   * @param {number} ms at most
   * @returns {Promise<number[]>} nothing if the time is over
   * @throws {GoneError}
   */
  async read(ms) {
    if (!this.#heard.length && !this.#isLost) {
      await new Promise((resolve) => {
        const timer = setTimeout(resolve, ms);
        this.#wake = () => {
          clearTimeout(timer);
          resolve(undefined);
        };
      });
      this.#wake = () => {};
    }
    if (!this.#heard.length && this.#isLost) throw new GoneError("the port has gone");
    const heard = this.#heard;
    this.#heard = [];
    return heard;
  }

  /** Writes after what is being written. @param {Uint8Array} bytes @throws {GoneError} it takes nothing any more */
  write(bytes) {
    const written = this.#writing.then(() => this.#writeAlone(bytes));
    this.#writing = written.catch(() => {});
    return written;
  }

  /** @param {Uint8Array} bytes */
  async #writeAlone(bytes) {
    const late = passed(WRITE_MS).then(() => Promise.reject(new GoneError("the port takes nothing")));
    late.catch(() => {}); // where nobody waits for it any more
    /** @type {WritableStreamDefaultWriter<Uint8Array> | undefined} */
    let writer;
    try {
      writer = this.port.writable?.getWriter();
      if (!writer) throw new GoneError();
      await Promise.race([writer.write(bytes), late]);
    } catch {
      throw new GoneError("the port has gone");
    } finally {
      writer?.releaseLock();
    }
  }

  /** Resets the board; what it said before is forgotten. @throws {GoneError} */
  async reset() {
    try {
      await this.port.setSignals({ dataTerminalReady: false, requestToSend: false });
      await passed(HELD_MS);
      await this.port.setSignals({ dataTerminalReady: true, requestToSend: true });
    } catch {
      throw new GoneError("the port has gone");
    }
    await passed(START_MS);
    this.#heard = [];
  }

  async close() {
    if (this.#isClosing) return;
    this.#isClosing = true;
    await this.#reader?.cancel().catch(() => {});
    await this.#pump;
    await this.port.close().catch(() => {});
  }
}
