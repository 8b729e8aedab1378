// The source that is real tiles on this machine's USB, through the browser's Web Serial: no server takes part.

/** @import { Image } from "./intel_hex.js" */
/** @import { WebPort, WebSerial } from "./serial.js" */
/** @import { Command, Listener, Look, Place, StreamEvent } from "./source.js" */
/** @import { Neighbours } from "./layout.js" */
import { arrange } from "./layout.js";
import { OFFSETS, SIDES, STREAM_VERSION } from "./source.js";
import { UsbTile } from "./usb_tile.js";

/** What a page can do with them; the rest only a hand at the tiles can. */
const TAKES = ["freeze", "blink", "restart", "set"];
const TICK_MS = 100;
const MS = 1000;
const BLINK_S = 5;
// Settings of `updates`: a tile that stops after the first one stands still; 0: it goes on for ever.
const [STOPPED, FOR_EVER] = [1, 0];

/** Tells of the tiles behind the ports that the browser has granted. */
export class UsbSource {
  /** @type {Map<string, UsbTile>} */
  tiles = new Map();
  /** @type {StreamEvent[]} */
  #events = [];
  /** What the page was told last, of each port and kind. @type {Map<string, string>} */
  #told = new Map();
  /** Who is on which side of whom, as tiles have said it. @type {Neighbours} */
  #neighbours = new Map();
  /** The setting `updates` of tiles that were frozen here, by their ids. @type {Map<number, number>} */
  #thawed = new Map();
  #began = Date.now();
  /** @type {Promise<unknown>} */
  closed = Promise.resolve();
  #timer;

  /**
   * @param {WebSerial} serial
   * @param {Look[]} looks of the classes that tiles may show
   * @param {Listener} listener
   */
  constructor(serial, looks, listener) {
    this.serial = serial;
    this.looks = looks;
    this.listener = listener;
    this.#tell({ stream: STREAM_VERSION, source: "watched", takes: TAKES, looks });
    this.#tell({ run: { seed: 0, shape: "-", tiles: 0, began: this.#began / MS } });
    serial.addEventListener("connect", this.#connected);
    this.#timer = setInterval(() => this.#tick(), TICK_MS);
  }

  get #time() {
    return (Date.now() - this.#began) / MS;
  }

  /** @param {Omit<StreamEvent, "time">} event */
  #tell(event) {
    this.#events.push({ time: this.#time, ...event });
  }

  /** Tells it where it is news. @param {Omit<StreamEvent, "time">} event @param {string} kind */
  #tellNews(event, kind) {
    const [subject, text] = [`${event.port} ${kind}`, JSON.stringify(event)];
    if (this.#told.get(subject) === text) return;
    this.#told.set(subject, text);
    this.#tell(event);
  }

  /** A board that was unplugged is back, or another one that the page may use. @param {Event} event */
  #connected = (event) => this.add(/** @type {WebPort} */ (/** @type {unknown} */ (event.target)));

  /** Watches the tile behind a port from now on. @param {WebPort} port */
  async add(port) {
    const tiles = [...this.tiles.values()];
    const known = tiles.find((one) => one.webPort === port);
    if (known) return known.open();
    const back = tiles.find((one) => one.isAway && isLike(one.webPort, port));
    if (back) return back.comeBack(port);
    const tile = new UsbTile(`usb-${tiles.length + 1}`, port, (event) => this.#tell(event));
    this.tiles.set(tile.name, tile);
    return tile.open();
  }

  /** Writes an image to all tiles that do not run it yet, side by side. @param {Image} image */
  async flash(image) {
    await Promise.all([...this.tiles.values()].map((tile) => tile.flash(image)));
  }

  #tick() {
    const places = this.#lay();
    for (const tile of this.tiles.values()) {
      this.#tellNews({ port: tile.name, display: this.#display(tile) }, "display");
      this.#tellNews({ port: tile.name, health: { trouble: tile.trouble, links: linksOf(tile, places) } }, "health");
    }
    this.#tell({ pace: { speed: 1, paused: false, share: 1 } });
    const events = this.#events;
    this.#events = [];
    this.listener.onEvents(events);
  }

  /** What a tile's display must look like, by what it says. @param {UsbTile} tile */
  #display(tile) {
    const look = this.looks.find(({ label }) => label === tile.label);
    if (!tile.isOpen || !look) return { segments: 0, rgb: [0, 0, 0], leds: tile.isOpen ? tile.known.links : "----" };
    return { segments: look.segments, rgb: look.rgb, leds: tile.known.links };
  }

  /** Places, as neighbours say; tiles without an id are in a row below, others that have no port are told, too. */
  #lay() {
    const cells = this.#cells();
    /** @type {Map<string, UsbTile>} */
    const taken = new Map();
    const below = Math.max(-1, ...[...cells.values()].map(([row]) => row)) + 1;
    let rest = 0;
    for (const tile of this.tiles.values()) {
      let place = tile.tile ? cells.get(tile.tile) : undefined;
      if (!place || taken.has(place.join())) place = [below, rest++];
      taken.set(place.join(), tile);
      this.#tellNews({ port: tile.name, place, tile: tile.tile }, "place");
    }
    const here = new Set([...this.tiles.values()].map(({ tile }) => tile));
    for (const number of new Set([...cells.keys(), ...this.#neighbours.keys()])) {
      const place = here.has(number) ? null : cells.get(number) ?? null;
      this.#layAway(number, place);
    }
    return taken;
  }

  /** A tile that others hear, and that is behind no port. @param {number} number @param {Place | null} place */
  #layAway(number, place) {
    const port = `(tile ${number})`;
    if (!place && !this.#told.has(`${port} place`)) return;
    this.#tellNews({ port, place, ...(place && { tile: number }) }, "place");
    if (!place) return;
    this.#tellNews({ port, open: false, reason: "no port" }, "open");
    this.#tellNews({ port, health: { trouble: "no port", links: {} } }, "health");
  }

  #cells() {
    /** @type {Neighbours} */
    const heard = new Map();
    for (const { tile, known } of this.tiles.values()) {
      if (!tile || !Object.keys(known.link).length) continue;
      /** @type {Map<string, [number, string]>} */
      const sides = new Map();
      for (const { side, neighbour, neighbourSide } of Object.values(known.link)) {
        if (neighbour && neighbourSide && known.links.includes(side)) sides.set(side, [neighbour, neighbourSide]);
      }
      heard.set(tile, sides);
    }
    // A neighbour that is not heard any more still lies there, unless tiles say otherwise by now.
    for (const [tile, sides] of heard) this.#neighbours.set(tile, new Map([...(this.#neighbours.get(tile) ?? []), ...sides]));
    const found = arrange(this.#neighbours);
    if (!found.conflicts) return found.cells;
    this.#neighbours = heard;
    return arrange(heard).cells;
  }

  /** @param {Command} command */
  send(command) {
    const chosen = command.port === undefined || command.port === null
      ? [...this.tiles.values()].filter((tile) => tile.isOpen) : [this.tiles.get(String(command.port))];
    for (const tile of chosen) if (tile) this.#order(tile, command);
  }

  /** @param {UsbTile} tile @param {Command} command */
  async #order(tile, command) {
    const text = this.#words(tile, command);
    if (text && !(await tile.order(text).catch(() => false))) {
      this.#tell({ refused: `tile ${tile.tile || tile.name} cannot be told that now: it is away, or being flashed` });
    }
  }

  /** @param {UsbTile} tile @param {Command} command */
  #words(tile, command) {
    switch (command.do) {
      case "blink":
        return `BLINK,${command.seconds ?? BLINK_S}`;
      case "restart":
        return "RESTART";
      case "set":
        return `SET,${command.name},${command.value}`;
      case "freeze":
        return `SET,updates,${command.on === false ? this.#thaw(tile) : this.#freeze(tile)}`;
      default:
        return "";
    }
  }

  /** @param {UsbTile} tile */
  #freeze({ tile, hello }) {
    if (hello && hello.updates !== STOPPED) this.#thawed.set(tile, hello.updates);
    return STOPPED;
  }

  /** @param {UsbTile} tile */
  #thaw({ tile }) {
    return this.#thawed.get(tile) ?? FOR_EVER;
  }

  /** Gives all ports back; `closed` comes when it is done. */
  close() {
    clearInterval(this.#timer);
    this.serial.removeEventListener("connect", this.#connected);
    this.closed = Promise.all([...this.tiles.values()].map((tile) => tile.close()));
  }
}

/** Whether both are boards of one kind. @param {WebPort} one @param {WebPort} other */
function isLike(one, other) {
  const [a, b] = [one.getInfo(), other.getInfo()];
  return a.usbVendorId === b.usbVendorId && a.usbProductId === b.usbProductId;
}

/**
 * How the links of a tile are.
 * @param {UsbTile} tile @param {Map<string, UsbTile>} places
 */
function linksOf(tile, places) {
  /** @type {Record<string, [string, number | null]>} */
  const links = {};
  if (tile.trouble) return links;
  const [at] = [...places].find(([, one]) => one === tile) ?? ["0,0"];
  const [row, col] = at.split(",").map(Number);
  [...SIDES].forEach((side, index) => {
    const health = tile.health.get(side);
    const beside = places.get([row + OFFSETS[index][0], col + OFFSETS[index][1]].join());
    // A tile lies there that speaks, and is not heard.
    const isDeaf = beside !== undefined && beside.label !== "" && !beside.trouble && tile.label !== "";
    const mark = health?.mark(tile.known.links.includes(side)) || (isDeaf ? "dead" : "");
    if (mark) links[side] = [mark, health?.good ?? null];
  });
  return links;
}
