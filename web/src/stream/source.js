// The emulator behind the page: one run at a time, at any speed, with hands in it. The twin of
// `tilenca.page.emulated`: the same commands give the same events (docs/PROTOCOL.md section 7).
import { TilencaError } from "../module.js";
import { Board } from "./board.js";
import { MOST_TILES, checked } from "./commands.js";
import { sorted } from "./faults.js";
import { Lines } from "./lines.js";
import { Pace } from "./pace.js";
import { SIDES } from "./sides.js";

// Up to this speed there is time to look at single frames on the cables.
const FRAMES_SPEED = 0.3;
const NO_POWER = "no power";
const UNKNOWN = "-";

/** @typedef {import("./board.js").Place} Place */
/** @typedef {import("./commands.js").Command} Command */
/** @typedef {{ time: number, [subject: string]: unknown }} StreamEvent */

/**
 * What the page is offered: made by `python -m release.page_bundle`.
 * @typedef {object} Offer
 * @property {StreamEvent & { drawings: { name: string, rows: string[] }[] }} stream the first event
 * @property {number | null} period_ms of the image's settings
 * @property {number} updates of the same
 */

/** @typedef {{ place: string, powered: boolean | null, display: string, lines: Lines }} Seen what the page was told of a tile */

/** @param {number} time @param {Record<string, unknown>} about @returns {StreamEvent} */
const event = (time, about) => ({ time: Number(time.toFixed(6)), ...about });

/** @param {number} index */
const portName = (index) => `tile-${String(index + 1).padStart(2, "0")}`;

export class EmulatedSource {
  /** @type {Board | null} */
  #board = null;
  #pace = new Pace(1, true);
  #isResting = false;
  /** @type {StreamEvent[]} */
  #events = [];
  /** @type {Seen[]} */
  #seen = [];
  /** The cables that the page knows to be cut. @type {import("../array.js").Link[]} */
  #cut = [];

  /**
   * @param {import("../emulator.js").Emulator} emulator
   * @param {import("../array.js").Image} image
   * @param {Offer} offer
   * @param {() => number} clock seconds, for the pace
   */
  constructor(emulator, image, offer, clock) {
    this.emulator = emulator;
    this.image = image;
    this.offer = offer;
    this.clock = clock;
  }

  /** What is here: labels with their looks, drawings, limits. */
  begin() {
    return [this.offer.stream];
  }

  // --- commands ---

  /** Carries out a command. @param {Command} given @throws {TilencaError} it cannot; in words for a person */
  take(given) {
    const command = checked(given);
    switch (command.do) {
      case "open":
        this.#open(command);
        break;
      case "rest":
        this.#isResting = command.on;
        break;
      case "pace":
        this.#pace.set(command.speed, command.paused);
        this.#tellPace();
        break;
      case "step":
        if (this.#pace.paused && this.#board) {
          this.#run(command.seconds);
          this.#pace.set(this.#pace.speed, true);
        }
        break;
      default:
        this.#layHandsOn(command);
    }
    this.#tellPlaces();
  }

  /** @param {Command} command */
  #layHandsOn(command) {
    const board = this.#board;
    if (!board) throw new TilencaError("nothing runs yet; open a drawing first");
    switch (command.do) {
      case "put":
        if (board.places.size >= MOST_TILES) {
          throw new TilencaError(`the board has ${MOST_TILES} tiles, which is all; take one out first`);
        }
        return board.put([command.row, command.col]);
      case "pull":
        return board.pull(this.#tile(command.port));
      case "move":
        return board.move(this.#tile(command.port), [command.row, command.col]);
      case "arrange":
        return board.arrange(sorted(command.cells));
      case "cut":
        return board.connect(this.#tile(command.port), SIDES.indexOf(command.side), !command.on);
      case "power":
        board.array.tile(this.#tile(command.port)).powered = command.on;
        return undefined;
      case "freeze":
        return board.freeze(this.#tile(command.port), command.on);
      case "reset":
        return board.array.tile(this.#tile(command.port)).reset();
      case "noise":
        return board.faults.spoilAll("loss", command.loss);
      default:
        throw new TilencaError(`${command.do}: whoever stands before the source takes it`);
    }
  }

  /** The tile of that port, which lies on the board. @param {string} port */
  #tile(port) {
    for (const tile of this.#board?.places.keys() ?? []) if (portName(tile) === port) return tile;
    throw new TilencaError(`no tile ${port} lies on the board`);
  }

  /** @param {Command} wanted */
  #open(wanted) {
    /** @type {Place[]} */
    const cells = sorted(wanted.cells);
    const name = this.#nameOf(cells);
    const board = new Board(this.emulator, {
      image: this.image, name, cells, seed: wanted.seed, faults: wanted.faults, spreadS: wanted.spread_s,
      periodMs: this.offer.period_ms, updates: this.offer.updates,
    });
    this.close();
    this.#board = board;
    this.#seen = [];
    this.#cut = [];
    this.#pace = new Pace(wanted.speed, wanted.paused, wanted.until_s);
    this.#events = [event(0, { run: { seed: wanted.seed, shape: name, tiles: cells.length } })];
    this.#look();
  }

  /** The name of the drawing with these cells, if it is one of those offered. @param {Place[]} cells */
  #nameOf(cells) {
    const top = Math.min(...cells.map(([row]) => row));
    const left = Math.min(...cells.map(([, col]) => col));
    const places = new Set(cells.map(([row, col]) => `${row - top},${col - left}`));
    const isIt = (/** @type {{ rows: string[] }} */ { rows }) => {
      const tiles = rows.flatMap((marks, row) => [...marks].flatMap((mark, col) => (mark === "#" ? [`${row},${col}`] : [])));
      return tiles.length === places.size && tiles.every((tile) => places.has(tile));
    };
    const name = this.offer.stream.drawings.find(isIt)?.name;
    return name?.slice(name.indexOf("/") + 1) ?? UNKNOWN;
  }

  // --- time ---

  /** Runs on at the pace; returns what has happened. @param {number} wallS @throws {TilencaError} it cannot go on */
  advance(wallS) {
    if (this.#board && !this.#isResting) this.#run(this.#pace.take(wallS, this.#board.array.timeS));
    const events = this.#events;
    this.#events = [];
    return events;
  }

  /** Whether it is paused, or nobody looks. */
  get isIdle() {
    return !this.#board || this.#pace.paused || this.#isResting;
  }

  /** @param {number} seconds */
  #run(seconds) {
    if (seconds <= 0 || !this.#board) return;
    const { array, faults } = this.#board;
    const [startedS, beforeS] = [this.clock(), array.timeS];
    try {
      faults.run(seconds);
    } catch (error) {
      this.#pace.paused = true;
      this.#look();
      throw error;
    }
    this.#pace.ran(array.timeS - beforeS, this.clock() - startedS, array.timeS);
    this.#look();
  }

  // --- what the page is told ---

  #look() {
    if (!this.#board) return;
    const { array, traffic } = this.#board;
    const now = array.timeS;
    this.#tellPlaces();
    const frames = traffic.read();
    if (this.#pace.speed > 0 && this.#pace.speed <= FRAMES_SPEED) {
      for (const frame of frames) {
        this.#tell(frame.timeS, { port: portName(frame.tile), side: SIDES[frame.side], frame: frame.data });
      }
    }
    const said = this.#seen.flatMap(({ lines }, index) => {
      const tile = array.tile(index);
      for (let got = tile.receive(); got.values.length > 0; got = tile.receive()) lines.feed(got.values, got.times);
      return lines.take().map((line) => ({ ...line, index }));
    });
    said.sort((one, two) => one.timeS - two.timeS || (portName(one.index) < portName(two.index) ? -1 : 1));
    for (const { timeS, raw, index } of said) this.#tell(timeS, { port: portName(index), raw });
    this.#seen.forEach((seen, index) => {
      const tile = array.tile(index);
      const leds = [...SIDES].map((name, side) => ((tile.leds >> side) & 1 ? name : "-")).join("");
      const display = { segments: tile.segments, rgb: [...tile.rgb], leds };
      if (JSON.stringify(display) === seen.display) return;
      seen.display = JSON.stringify(display);
      this.#tell(now, { port: portName(index), display });
    });
    this.#tellPace();
  }

  /** What lies where, has power, and is joined, as far as it is news. */
  #tellPlaces() {
    if (!this.#board) return;
    const { array, places, cut } = this.#board;
    const now = array.timeS;
    while (this.#seen.length < array.size) {
      this.#seen.push({ place: "", powered: null, display: "", lines: new Lines() });
    }
    this.#seen.forEach((seen, index) => {
      const [port, place, { powered }] = [portName(index), places.get(index), array.tile(index)];
      if ((place?.join() ?? "") !== seen.place) {
        seen.place = place?.join() ?? "";
        this.#tell(now, { port, place: place ? [...place] : null });
      }
      if (place && powered !== seen.powered) {
        seen.powered = powered;
        this.#tell(now, { port, open: powered, reason: powered ? "" : NO_POWER });
      }
    });
    const [before, after] = [this.#cut, cut].map((links) => new Set(links.map(String)));
    const news = [...this.#cut, ...cut].filter((link) => before.has(String(link)) !== after.has(String(link)));
    for (const link of sorted(news)) {
      this.#tell(now, { port: portName(link[0]), side: SIDES[link[1]], cable: after.has(String(link)) ? "cut" : "whole" });
    }
    this.#cut = cut;
  }

  #tellPace() {
    if (!this.#board) return;
    const { speed, paused, share } = this.#pace;
    this.#tell(this.#board.array.timeS, { pace: { speed, paused, share: Number(share.toFixed(3)) } });
  }

  /** @param {number} time @param {Record<string, unknown>} about */
  #tell(time, about) {
    this.#events.push(event(time, about));
  }

  /** Frees the tiles. */
  close() {
    this.#board?.array.free();
    this.#board = null;
  }
}
