// Tiles on this machine's USB, in browsers that can speak to serial ports: which there are, and flashing them.

/** @import { Image } from "../stream/intel_hex.js" */
/** @import { WebPort } from "../stream/serial.js" */
/** @import { Listener, Look, Model, Source } from "../stream/source.js" */
/** @import { Tiles } from "../stream/tiles.js" */
/** @import { UsbTile } from "../stream/usb_tile.js" */
import { parseElf } from "../stream/elf.js";
import { ImageError, checkMemory, readImage } from "../stream/intel_hex.js";
import { webSerial } from "../stream/serial.js";
import { UsbSource } from "../stream/usb.js";
import { element, icon, setText } from "./dom.js";

const ICON = "M9 3v5M15 3v5M7 8h10v4a5 5 0 0 1-10 0zM12 17v4";
/** Where the bundle that needs no server has its firmware. */
const OWN = "emulator/firmware.elf";
const RESULTS = { flashed: "flashed; it runs this firmware", current: "runs this firmware already", failed: "", "": "" };

/**
 * @typedef {{
 *   say: (text: string) => void,
 *   choose: (open: ((listener: Listener) => Source) | null) => void,
 * }} UsbDeeds `choose` opens another source; null: the one that the page began with
 * @typedef {{row: HTMLElement, who: HTMLElement, what: HTMLElement, words: HTMLElement, bar: HTMLProgressElement}} Row
 */

/** How many tiles. @param {number} count */
const counted = (count) => `${count} tile${count === 1 ? "" : "s"}`;

export class UsbPanel {
  /** @param {HTMLElement} root @param {HTMLElement} top @param {Tiles} tiles @param {UsbDeeds} deeds */
  constructor(root, top, tiles, deeds) {
    this.root = root;
    this.tiles = tiles;
    this.deeds = deeds;
    this.serial = webSerial();
    /** @type {UsbSource | null} */
    this.source = null;
    /** What the page knew of classes and models before. @type {Look[]} */
    this.looks = [];
    /** @type {Model[]} */
    this.models = [];
    /** @type {Image | null} */
    this.image = null;
    this.isFlashing = false;
    /** @type {Map<string, Row>} */
    this.rows = new Map();
    this.button = element("button", { type: "button", class: "compact", hidden: true, title: "Watch and flash the tiles on this machine's USB", onclick: () => this.connect() },
      icon(ICON), element("span", {}, "Connect tiles"));
    top.append(this.button);
    this.file = element("input", { type: "file", accept: ".hex", id: "usb-file", onchange: () => this.choose() });
    this.own = element("button", { type: "button", hidden: true, onclick: () => this.takeOwn() }, "Take the firmware of this page");
    this.about = element("p", { class: "summary", id: "usb-about" }, "Choose the firmware.hex that pio run builds.");
    this.flash = element("button", { type: "button", class: "primary", disabled: true, onclick: () => this.flashAll() }, "Flash all tiles");
    this.status = element("p", { role: "status" });
    this.list = element("ul", { class: "ports", "aria-label": "Tiles on USB" });
    root.append(
      element("h2", { id: "usb-title" }, "On USB"),
      element("p", { class: "summary" }, "The browser asks which port the page may use, once for each tile."),
      element("div", { class: "deeds" },
        element("button", { type: "button", onclick: () => this.add() }, "Add a tile…"),
        element("button", { type: "button", onclick: () => this.leave() }, "Disconnect all")),
      element("h3", {}, element("label", { for: "usb-file" }, "Firmware to flash")),
      this.file, this.own, this.about, this.flash, this.status,
      this.list,
    );
    addEventListener("beforeunload", (event) => {
      if (this.isFlashing) event.preventDefault();
    });
  }

  /** Offers it where the browser can do it. @param {string} behind what stands behind the page */
  offer(behind) {
    this.button.hidden = !this.serial || behind === "recording";
    this.own.hidden = behind !== "emulator";
  }

  /** Goes over to the tiles whose ports the page may use; asks for one where there is none. */
  async connect() {
    const { serial } = this;
    if (!serial || this.source) return;
    const ports = await serial.getPorts();
    if (!ports.length) {
      const asked = await this.ask();
      if (!asked) return;
      ports.push(asked);
    }
    this.looks = this.tiles.looks;
    this.models = this.tiles.models;
    this.deeds.choose((listener) => (this.source = new UsbSource(serial, this.looks, listener)));
    this.root.hidden = false;
    this.button.hidden = true;
    await Promise.all(ports.map((port) => this.source?.add(port)));
  }

  /** The port that a person chooses; null: none. @returns {Promise<WebPort | null>} */
  async ask() {
    try {
      return (await this.serial?.requestPort()) ?? null;
    } catch (error) {
      if (!(error instanceof DOMException && error.name === "NotFoundError")) throw error;
      this.deeds.say("No port was chosen. Plug a tile in by USB, and choose its port.");
      return null;
    }
  }

  async add() {
    const port = await this.ask();
    if (port) await this.source?.add(port);
  }

  /** Back to what stood behind the page before. */
  leave() {
    return this.release(() => this.deeds.choose(null));
  }

  /** Goes away for another source, but not in the middle of flashing. @param {() => void} go closes this one, and opens the other */
  async release(go) {
    if (this.isFlashing) {
      this.deeds.say("Tiles are being flashed; wait until they are done.");
      return;
    }
    const { source } = this;
    this.source = null;
    for (const { row } of this.rows.values()) row.remove();
    this.rows.clear();
    setText(this.status, "");
    this.root.hidden = true;
    go();
    if (!source) return;
    await source.closed; // the ports cannot be opened again before that
    this.button.hidden = false;
  }

  /** Reads the chosen image. */
  async choose() {
    const [file] = this.file.files ?? [];
    if (file) await this.take(async () => readImage(file.name, new Uint8Array(await file.arrayBuffer())));
  }

  /** The firmware that the emulated tiles of the page run. */
  async takeOwn() {
    await this.take(async () => {
      const answer = await fetch(OWN);
      if (!answer.ok) throw new ImageError(`${OWN}: ${answer.status}; choose a firmware.hex`);
      return checkMemory(OWN, parseElf(OWN, new Uint8Array(await answer.arrayBuffer())));
    });
    this.file.value = "";
  }

  /** @param {() => Promise<Image>} read */
  async take(read) {
    this.image = null;
    let text = "";
    try {
      this.image = await read();
      text = `${this.image.name}: ${this.image.size} bytes, firmware id ${this.image.firmwareId}`;
    } catch (error) {
      if (!(error instanceof ImageError)) throw error;
      text = error.message;
    }
    setText(this.about, text);
    this.about.classList.toggle("bad", !this.image);
    this.update();
  }

  async flashAll() {
    if (!this.source || !this.image || this.isFlashing) return;
    this.isFlashing = true;
    const { tiles } = this.source;
    setText(this.status, `Flashing ${counted(tiles.size)}. Leave them plugged in.`);
    this.update();
    try {
      await this.source.flash(this.image);
    } finally {
      this.isFlashing = false;
    }
    const results = [...tiles.values()].map(({ flashing }) => flashing.result);
    const failed = results.filter((result) => result === "failed").length;
    const current = results.filter((result) => result === "current").length;
    const written = results.length - failed - current;
    const skipped = current ? ` ${current} had it already.` : "";
    setText(this.status, `${counted(written)} flashed.${skipped}${failed ? ` ${failed} failed: see below.` : ""}`);
    this.status.classList.toggle("bad", failed > 0);
    this.update();
  }

  update() {
    if (!this.source) return;
    this.flash.disabled = !this.image || this.isFlashing || !this.source.tiles.size;
    this.file.disabled = this.isFlashing;
    for (const tile of this.source.tiles.values()) this.show(tile);
  }

  /** @param {UsbTile} tile */
  show(tile) {
    const row = this.rows.get(tile.name) ?? this.newRow(tile.name);
    setText(row.who, tile.tile ? `Tile ${tile.tile}` : "A tile");
    setText(row.what, ` at ${tile.name}: ${this.firmwareOf(tile)}`);
    const { phase, share, result, error } = tile.flashing;
    const percent = share === null ? "" : ` ${Math.floor(share * 100)} %`;
    setText(row.words, error || RESULTS[result] || `${phase}${percent}`);
    row.words.classList.toggle("bad", result === "failed");
    row.bar.hidden = share === null;
    if (share !== null) row.bar.value = share;
  }

  /** @param {UsbTile} tile */
  firmwareOf({ isOpen, hello }) {
    if (!isOpen) return "away";
    if (!hello) return "firmware not known";
    const model = this.models.find(({ id }) => id === hello.modelId)?.name ?? `model ${hello.modelId}`;
    return `${model}, firmware ${hello.firmwareId}`;
  }

  /** @param {string} name */
  newRow(name) {
    const who = element("strong");
    const what = element("span");
    const words = element("p");
    const bar = element("progress", { max: 1, value: 0, hidden: true, "aria-label": `Flashing ${name}` });
    const row = { row: element("li", {}, element("p", {}, who, what), words, bar), who, what, words, bar };
    this.rows.set(name, row);
    this.list.append(row.row);
    return row;
  }
}
