// One tile behind a port of the browser: what it says, what it is told, and how it is flashed.

/** @import { Image } from "./intel_hex.js" */
/** @import { Hello, Sentence } from "./sentences.js" */
/** @import { WebPort } from "./serial.js" */
/** @import { StreamEvent } from "./source.js" */
import { LineReader } from "./line_reader.js";
import { LinkHealth } from "./link_health.js";
import { framed, parseSentence } from "./sentences.js";
import { BytePort, GoneError, passed } from "./serial.js";
import { FlashError, program } from "./stk500.js";
import { hear, newTile } from "./tile.js";

const READ_MS = 100;
// After a reset the bootloader takes any byte for the beginning of a command. So a tile is asked only once it has
// spoken, but for what may be left from before the reset, or has had the time to.
const STALE_MS = 300;
const BOOT_MS = 3000;
const AGAIN_MS = 1000;
const PATIENCE_MS = 7000;
/** A tile that was asked for its HELLO answers by then; a later one is a start. */
const ANSWER_MS = 2000;
const LOOK_MS = 50;
const QUIET_MS = 3000;

const AWAY = "it was unplugged; connect it again";

/**
 * How its flashing goes: words for a person, the share that is done (null: nobody knows), and how it ended.
 * @typedef {{phase: string, share: number | null, result: "" | "flashed" | "current" | "failed", error: string}} Flashing
 */

/** @type {Flashing} */
const NOTHING_YET = { phase: "", share: null, result: "", error: "" };

export class UsbTile {
  #reader = new LineReader();
  #listens = false;
  #listening = Promise.resolve();
  /** @type {Promise<void> | null} */
  #opening = null;
  /** The id that it said last, also behind another port. */
  #saidId = 0;
  #openMs = 0;
  #askMs = 0;
  #answerMs = 0;
  #heardMs = 0;

  /**
   * @param {string} name on the page @param {WebPort} port
   * @param {(event: Omit<StreamEvent, "time">) => void} tell
   */
  constructor(name, port, tell) {
    this.name = name;
    this.webPort = port;
    this.port = new BytePort(port);
    this.tell = tell;
    this.isOpen = false;
    this.isWatched = true;
    this.isBusy = false;
    this.isWritten = false;
    /** As it says itself. */
    this.known = newTile(name);
    this.label = "";
    /** Of each side. @type {Map<string, LinkHealth>} */
    this.health = new Map();
    /** Its id; 0: it has not said it, or has none. */
    this.tile = 0;
    /** @type {Hello | null} */
    this.hello = null;
    /** @type {Flashing} */
    this.flashing = NOTHING_YET;
  }

  /** Whether it was unplugged; a browser that does not say so has at least no open port. */
  get isAway() {
    return !this.isOpen && this.webPort.connected !== true;
  }

  /** It was plugged in again: the browser has another port for it then. @param {WebPort} port */
  async comeBack(port) {
    await this.#opening;
    this.webPort = port;
    this.port = new BytePort(port);
    this.tile = 0;
    this.#forget();
    await this.open();
  }

  /** Opens its port, and listens; once, however often it is called meanwhile. */
  open() {
    this.#opening ??= this.#open().finally(() => {
      this.#opening = null;
    });
    return this.#opening;
  }

  async #open() {
    if (this.isOpen || !this.isWatched) return;
    try {
      await this.port.open();
    } catch (error) {
      const reason = error instanceof Error && error.name === "NetworkError"
        ? "it cannot be opened; close what else uses it (a monitor, another page), then add it again"
        : `it cannot be opened: ${error instanceof Error ? error.message : error}`;
      this.tell({ port: this.name, open: false, reason });
      return;
    }
    this.isOpen = true;
    this.tell({ port: this.name, open: true });
    this.#listen();
  }

  /** From now on, what it says is news. @param {number[]} heard what it has said already */
  #listen(heard = []) {
    this.#reader = new LineReader();
    this.hello = null;
    this.#openMs = this.#heardMs = performance.now();
    this.#askMs = this.#openMs + BOOT_MS;
    this.#answerMs = 0;
    this.#listens = true;
    this.#listening = this.#run(heard);
  }

  /** @param {number[]} heard */
  async #run(heard) {
    try {
      while (this.#listens) {
        for (const line of this.#reader.feed(Uint8Array.from(heard))) this.#take(line);
        await this.#ask();
        heard = await this.port.read(READ_MS);
      }
    } catch (error) {
      if (!(error instanceof GoneError)) throw error;
      this.#listens = false;
      await this.#gone();
    }
  }

  async #gone() {
    if (!this.isOpen) return;
    this.isOpen = false;
    this.hello = null;
    await this.port.close();
    if (this.isWatched) this.tell({ port: this.name, open: false, reason: AWAY });
  }

  /** Asks a tile that does not say by itself what it runs. */
  async #ask() {
    const now = performance.now();
    if (this.hello || now < this.#askMs || now > this.#openMs + PATIENCE_MS) return;
    this.#askMs = now + AGAIN_MS;
    await this.order("ASK");
    this.#answerMs = now + ANSWER_MS;
  }

  /** @param {string} line */
  #take(line) {
    const now = performance.now();
    const sentence = parseSentence(line);
    const asked = sentence?.name === "HELLO" && now < this.#answerMs;
    this.tell(asked ? { port: this.name, raw: line, asked } : { port: this.name, raw: line });
    if (!sentence) return;
    this.#heardMs = now;
    if (now > this.#openMs + STALE_MS) this.#askMs = Math.min(this.#askMs, now);
    this.#learn(sentence, asked);
  }

  /** @param {Sentence} sentence @param {boolean} asked */
  #learn(sentence, asked) {
    const label = hear(this.known, sentence, asked);
    if (label !== null) this.label = label;
    this.tile = sentence.tile || this.tile;
    if (this.#saidId && this.tile && this.tile !== this.#saidId && !this.isBusy) this.flashing = NOTHING_YET; // that was another one
    this.#saidId = this.tile || this.#saidId;
    if (sentence.name === "HELLO") {
      this.hello = sentence;
      this.#answerMs = 0;
      if (!asked) this.#forget();
    } else if (sentence.name === "LINK") {
      const health = this.health.get(sentence.side) ?? new LinkHealth();
      health.take(sentence);
      this.health.set(sentence.side, health);
    } else if (sentence.name === "ACK") {
      this.note(sentence.fields.join(" "));
    } else if (sentence.name === "NAK") {
      this.note(`refused a command: ${sentence.reason}`, true);
    }
  }

  /** What it has shown and heard is over. */
  #forget() {
    this.label = "";
    Object.assign(this.known, { links: "----", link: {} });
    this.health.clear();
  }

  /** A line of the log. @param {string} text */
  note(text, bad = false) {
    this.tell({ port: this.name, note: text, bad });
  }

  /** One word for a tile that is not heard; "" where all is well. */
  get trouble() {
    if (!this.isOpen || this.isWritten) return "away";
    return performance.now() - this.#heardMs > Math.max(QUIET_MS, 2 * this.known.periodMs) ? "silent" : "";
  }

  /** Tells it something. @param {string} text of a command, without its frame */
  async order(text) {
    if (!this.isOpen || !this.#listens) return false;
    await this.port.write(new TextEncoder().encode(framed(text)));
    return true;
  }

  /** Waits until it has said what it runs. */
  async #greeting() {
    const end = performance.now() + PATIENCE_MS;
    while (!this.hello && this.isOpen && performance.now() < end) await passed(LOOK_MS);
    return this.hello;
  }

  /**
   * Writes an image, reads it back, and asks the tile whether it runs it; nothing where it does already.
   * @param {Image} image
   */
  async flash(image) {
    if (this.isBusy) return;
    this.isBusy = true;
    try {
      await this.#flash(image);
    } catch (error) {
      this.#end("failed", error instanceof FlashError ? error.message : `it did not work (${error}); connect it anew, then flash it again`);
    } finally {
      this.isBusy = false;
    }
  }

  /** @param {Image} image */
  async #flash(image) {
    this.#progress("asking what it runs");
    await this.open();
    if (!this.isOpen) throw new FlashError("its port cannot be opened; connect it, then flash it again");
    if ((await this.#greeting())?.firmwareId === image.firmwareId) return this.#end("current");
    this.#listens = false;
    await this.#listening;
    if (!this.isOpen) throw new FlashError("the board went away; connect it and flash it again");
    /** @type {number[]} */
    let heard = [];
    this.#goDark();
    try {
      heard = await program(this.port, image.flash, (phase, share) => this.#progress(phase, share));
    } finally {
      this.isWritten = false;
      this.tell({ port: this.name, open: true });
      this.#listen(heard);
    }
    this.#progress("asking what it runs now");
    const hello = await this.#greeting();
    if (!hello) throw new FlashError("it was written and read back, but the tile says nothing; press its reset");
    if (hello.firmwareId !== image.firmwareId) {
      throw new FlashError(
        `it was written and read back, but the tile says it runs firmware ${hello.firmwareId}; press its reset, then flash it again`,
      );
    }
    return this.#end("flashed");
  }

  /** It shows and says nothing while it is written. */
  #goDark() {
    this.isWritten = true;
    this.#forget();
    this.tell({ port: this.name, open: false, reason: "is being flashed" });
  }

  /** @param {string} phase @param {number | null} share */
  #progress(phase, share = null) {
    this.flashing = { phase, share, result: "", error: "" };
  }

  /** @param {Flashing["result"]} result @param {string} error */
  #end(result, error = "") {
    this.flashing = { phase: "", share: null, result, error };
    if (result !== "current") this.note(result === "failed" ? `not flashed: ${error}` : "flashed", result === "failed");
  }

  /** Nobody watches it any more. */
  async close() {
    this.isWatched = false;
    await this.#opening;
    this.#listens = false;
    await this.#listening;
    if (!this.isOpen) return;
    this.isOpen = false;
    await this.port.close();
  }
}
