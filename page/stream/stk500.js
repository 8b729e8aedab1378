// Writes an image through the Mega's stock bootloader, and reads it back: STK500 version 2 (Atmel's application
// note AVR068) over a port of bytes. It knows no browser; `serial.js` has the ports.

/** @import { BytePort } from "./serial.js" */
import { GoneError } from "./serial.js";

/**
 * The progress of a board: `share` is 0..1 of the phase.
 * @typedef {(phase: Phase, share: number) => void} Report
 * @typedef {"connecting" | "trying again" | "writing" | "verifying"} Phase
 */

const [START, TOKEN, OK] = [0x1b, 0x0e, 0x00];
const SIGN_ON = 0x01;
const LOAD_ADDRESS = 0x06;
const ENTER_PROGMODE = 0x10;
const LEAVE_PROGMODE = 0x11;
const PROGRAM_FLASH = 0x13;
const READ_FLASH = 0x14;
const READ_SIGNATURE = 0x1b;

const PAGE_BYTES = 256;
/** Word addresses have 16 bits each side of such a border: the address is given anew there. */
const BORDER_BYTES = 0x20000;
const BEYOND_64K_WORDS = 0x80000000;
const LONGEST_ANSWER = PAGE_BYTES + 16;
const SIGNATURE = "1E9801";

/** The bootloader listens for a second or two after a reset. Greetings that come too close would run into each other. */
const GREETINGS = 3;
const GREETING_MS = 1000;
/** A page takes 9 ms to be written and 25 ms to be sent; much else may go on on this machine. */
const ANSWER_MS = 5000;
// The times and bytes by which a programmer would talk to a chip; the bootloader needs none of them.
const ENTER_BODY = [ENTER_PROGMODE, 200, 100, 25, 32, 0, 0x53, 3, 0xac, 0x53, 0, 0];
const PROGRAM_MODE = [0xc1, 10, 0x40, 0x4c, 0x20, 0, 0];
const READ_COMMAND = 0x20;
const SIGNATURE_COMMAND = 0x30;

/** Another attempt resets the board again, which helps where a byte was damaged or the cable was loose for a moment. */
const ATTEMPTS = 2;
/** @type {Phase[]} */
const PHASES = ["connecting", "trying again", "writing", "verifying"];

const NO_REPLY =
  "no reply from a Mega's bootloader; is this a Mega 2560? Reconnect its USB cable or press its reset, then flash it again";
const GONE = "the board went away; connect it and flash it again, its bootloader is intact";

/** Why a board was not programmed, and the remedy. */
export class FlashError extends Error {
  /** @param {string} message @param {boolean} isPassing whether another attempt could succeed */
  constructor(message, isPassing = true) {
    super(message);
    this.isPassing = isPassing;
  }
}

/** The conversation with one bootloader. */
class Programmer {
  #sequence = 0;
  /** @type {number[]} */
  #heard = [];

  /** @param {BytePort} port @param {Report} report */
  constructor(port, report) {
    this.port = port;
    /** @type {Phase} */
    this.phase = "connecting";
    this.report = report;
  }

  /** What came after the last answer: the program that the board runs by then has said it. */
  get rest() {
    return this.#heard;
  }

  /** @param {Phase} phase @param {number} share */
  tell(phase, share) {
    this.phase = phase;
    this.report(phase, share);
  }

  /** Resets the board, and greets its bootloader. */
  async begin() {
    await this.port.reset();
    this.#heard = [];
    for (let i = 0; i < GREETINGS; i++) {
      if (await this.#exchange([SIGN_ON], GREETING_MS)) return;
    }
    throw new FlashError(NO_REPLY);
  }

  /** @param {number[]} body @returns {Promise<Uint8Array>} what follows command and status in the answer */
  async ask(body) {
    const answer = await this.#exchange(body, ANSWER_MS);
    if (!answer) {
      throw new FlashError(this.phase === "writing" || this.phase === "verifying"
        ? `silent while ${this.phase}; reconnect it and flash it again` : NO_REPLY);
    }
    if (answer[1] !== OK) throw new FlashError(`the bootloader refused command 0x${hex(body[0])}; flash it again`);
    return answer.subarray(2);
  }

  /** @param {number[]} body @param {number} ms */
  async #exchange(body, ms) {
    this.#sequence = (this.#sequence + 1) & 0xff;
    const message = Uint8Array.of(START, this.#sequence, body.length >> 8, body.length & 0xff, TOKEN, ...body, 0);
    message[message.length - 1] = parity(message);
    await this.port.write(message);
    const end = performance.now() + ms;
    for (;;) {
      const found = this.#message();
      if (found?.[1] === this.#sequence && found[5] === body[0]) return found.subarray(5, -1);
      if (found) continue; // late, of an earlier greeting
      const left = end - performance.now();
      if (left <= 0) return null;
      this.#heard.push(...(await this.port.read(left)));
    }
  }

  /** Takes the first whole message out of what was heard; noise before it is skipped. */
  #message() {
    const heard = this.#heard;
    for (;;) {
      const start = heard.indexOf(START);
      heard.splice(0, start < 0 ? heard.length : start);
      if (heard.length < 6) return null;
      const size = heard[2] * 256 + heard[3];
      const length = size + 6;
      if (heard[4] === TOKEN && size >= 2 && size <= LONGEST_ANSWER) {
        if (heard.length < length) return null;
        const message = Uint8Array.from(heard.slice(0, length));
        if (parity(message) === 0) {
          heard.splice(0, length);
          return message;
        }
      }
      heard.shift(); // it was no beginning
    }
  }

  async signature() {
    const bytes = [];
    for (let i = 0; i < 3; i++) bytes.push((await this.ask([READ_SIGNATURE, 4, SIGNATURE_COMMAND, 0, i, 0]))[0]);
    return bytes.map(hex).join("");
  }

  /** From here on pages follow each other. @param {number} address in bytes */
  async #goTo(address) {
    const words = address / 2 + (address >= BORDER_BYTES ? BEYOND_64K_WORDS : 0);
    await this.ask([LOAD_ADDRESS, words >>> 24, (words >>> 16) & 0xff, (words >>> 8) & 0xff, words & 0xff]);
  }

  /** @param {Uint8Array} flash @param {Phase} phase @param {(page: Uint8Array, address: number) => Promise<void>} act */
  async #pages(flash, phase, act) {
    for (let address = 0; address < flash.length; address += PAGE_BYTES) {
      this.tell(phase, address / flash.length);
      if (address % BORDER_BYTES === 0) await this.#goTo(address);
      await act(flash.subarray(address, address + PAGE_BYTES), address);
    }
    this.tell(phase, 1);
  }

  /** Every page from address 0 on: the bootloader erases each one as it comes. @param {Uint8Array} flash in whole pages */
  write(flash) {
    return this.#pages(flash, "writing", async (page) => {
      await this.ask([PROGRAM_FLASH, PAGE_BYTES >> 8, PAGE_BYTES & 0xff, ...PROGRAM_MODE, ...page]);
    });
  }

  /** @param {Uint8Array} flash in whole pages */
  verify(flash) {
    return this.#pages(flash, "verifying", async (page, address) => {
      const read = await this.ask([READ_FLASH, PAGE_BYTES >> 8, PAGE_BYTES & 0xff, READ_COMMAND]);
      const wrong = page.findIndex((byte, i) => read[i] !== byte);
      if (wrong < 0) return;
      throw new FlashError(`verification failed at 0x${hex(address + wrong)}; flash it again, and if it repeats change the cable`);
    });
  }
}

/** @param {Uint8Array} bytes */
const parity = (bytes) => bytes.reduce((sum, byte) => sum ^ byte, 0);
/** @param {number} value */
const hex = (value) => value.toString(16).toUpperCase().padStart(2, "0");

/** The image in whole pages. @param {Uint8Array} flash */
function inPages(flash) {
  const whole = new Uint8Array(Math.ceil(flash.length / PAGE_BYTES) * PAGE_BYTES).fill(0xff);
  whole.set(flash);
  return whole;
}

/** @param {Programmer} programmer @param {Uint8Array} flash in whole pages */
async function programOnce(programmer, flash) {
  await programmer.begin();
  await programmer.ask(ENTER_BODY);
  const signature = await programmer.signature();
  if (signature !== SIGNATURE) {
    throw new FlashError(`wrong chip: its signature is 0x${signature}, an ATmega2560's is 0x${SIGNATURE}; is this a tile?`, false);
  }
  await programmer.write(flash);
  await programmer.verify(flash);
  await programmer.ask([LEAVE_PROGMODE, 1, 1]);
}

/**
 * Writes an image to the board behind a port, and reads it back. The board runs it then.
 * @param {BytePort} port open, and nobody else reads it
 * @param {Uint8Array} flash from address 0
 * @param {Report} report called as it goes on
 * @returns {Promise<number[]>} what the board has said since, as the program that was written
 * @throws {FlashError} it failed, twice where another attempt could succeed; the one that came further says why
 */
export async function program(port, flash, report) {
  const whole = inPages(flash);
  /** @type {{error: FlashError, phase: Phase} | null} */
  let before = null;
  for (let attempt = 1; ; attempt++) {
    const programmer = new Programmer(port, report);
    programmer.tell(attempt === 1 ? "connecting" : "trying again", 0);
    try {
      await programOnce(programmer, whole);
      return programmer.rest;
    } catch (caught) {
      const error = caught instanceof GoneError ? new FlashError(GONE, false) : caught;
      if (!(error instanceof FlashError)) throw error;
      const isFurther = before && PHASES.indexOf(before.phase) > PHASES.indexOf(programmer.phase);
      if (attempt === ATTEMPTS || !error.isPassing) throw before && isFurther ? before.error : error;
      before = { error, phase: programmer.phase };
    }
  }
}
