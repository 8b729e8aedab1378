// What the page knows of the tiles: the stream's events, added up.

/** @import { Drawing, Look, Place, StreamEvent } from "./source.js" */
/** @import { BoardSentence, LinkSentence, TimeSentence } from "./sentences.js" */
import { parseFrame } from "./frames.js";
import { parseSentence } from "./sentences.js";
import { History } from "./history.js";
import { OFFSETS, SIDES, STREAM_VERSION } from "./source.js";

/**
 * @typedef {{
 *   port: string, number: number, place: Place | null, powered: boolean, frozen: boolean,
 *   segments: number, rgb: number[], leds: string,
 *   label: string, margin: number | null, links: string, state: number[], updates: number, uptimeMs: number,
 *   modelId: string, channels: number, classes: number, periodMs: number,
 *   link: Record<string, LinkSentence>, time: TimeSentence | null, board: BoardSentence | null, error: string, countSide: number,
 * }} Tile
 *
 * @typedef {Tile & {place: Place}} LaidTile
 *
 * @typedef {{from: string, side: number, bytes: number}} Pulse
 */

/** @param {string} port @returns {Tile} */
function newTile(port) {
  return {
    port, number: Number(/(\d+)$/.exec(port)?.[1] ?? 0), place: null, powered: false, frozen: false,
    segments: 0, rgb: [0, 0, 0], leds: "----",
    label: "", margin: null, links: "----", state: [], updates: 0, uptimeMs: 0,
    modelId: "", channels: 0, classes: 0, periodMs: 0, link: {}, time: null, board: null, error: "", countSide: -1,
  };
}

export class Tiles {
  constructor() {
    /** @type {Map<string, Tile>} */
    this.byPort = new Map();
    /** The tiles on the board by their places, "row,col". @type {Map<string, Tile>} */
    this.byPlace = new Map();
    /** Ends of cut cables, "port side". @type {Set<string>} */
    this.cut = new Set();
    /** @type {Look[]} */
    this.looks = [];
    /** @type {Drawing[]} */
    this.drawings = [];
    /** What they are: "emulated", or a "recording". */
    this.source = "";
    this.mostTiles = 0;
    this.mostPlace = 0;
    this.stepS = 0.02;
    this.time = 0;
    this.pace = { speed: 1, paused: false, share: 1 };
    /** The time that one can go to at most; null: one cannot go back here. @type {number | null} */
    this.end = null;
    /** What hands have done in this run, and will do. @type {import("./deeds.js").Deed[]} */
    this.deeds = [];
    /** How often the run was taken to another time. */
    this.jumps = 0;
    this.seed = 0;
    this.runs = 0;
    this.startTiles = 0;
    this.history = new History();
    /** Frames that have come since the last look. @type {Pulse[]} */
    this.pulses = [];
    /** Ports whose picture is out of date. @type {Set<string>} */
    this.dirty = new Set();
    this.isMoved = false;
    /** Grows with everything that a verdict on the tiles depends on. */
    this.version = 0;
    this.refused = "";
  }

  /** Adds events. @param {StreamEvent[]} events */
  take(events) {
    for (const event of events) {
      const before = this.version;
      this.takeOne(event);
      if (this.version !== before) this.history.sample({ time: event.time, ...this.count() });
    }
  }

  /** @param {StreamEvent} event */
  takeOne(event) {
    if (event.stream !== undefined) {
      if (event.stream !== STREAM_VERSION) this.refused = `The server speaks version ${event.stream}: reload the page.`;
      this.source = event.source ?? "";
      this.looks = event.looks ?? [];
      this.drawings = event.drawings ?? [];
      this.mostTiles = event.most_tiles ?? 0;
      this.mostPlace = event.most_place ?? 0;
      this.stepS = (event.period_ms ?? 20) / 1000;
    } else if (event.run) {
      this.begin(event.run.seed, event.run.tiles);
    } else if (event.deed) {
      this.deeds = [...this.deeds.filter(({ time }) => time <= event.time), { time: event.time, deed: event.deed }];
    } else if (event.jump) {
      this.jump(event.time);
    } else if (event.pace) {
      this.pace = event.pace;
      this.time = event.time;
      this.end = event.pace.end ?? null;
      this.history.pass(event.time, event.pace.end);
    } else if (event.refused !== undefined) {
      this.refused = event.refused;
    } else if (event.port !== undefined) {
      this.takeOfTile(event, this.tile(event.port));
    }
  }

  /** @param {number} seed @param {number} tiles */
  begin(seed, tiles) {
    this.jump(0);
    this.history = new History();
    this.deeds = [];
    this.end = null;
    this.seed = seed;
    this.startTiles = tiles;
    this.runs++;
  }

  /** The run has gone to another time: what follows tells all that is there. @param {number} time */
  jump(time) {
    this.byPort.clear();
    this.byPlace.clear();
    this.cut.clear();
    this.pulses = [];
    this.time = time;
    this.history.jumpedTo = time;
    this.jumps++;
    this.version++;
    this.isMoved = true;
  }

  /** @param {string} port */
  tile(port) {
    let tile = this.byPort.get(port);
    if (!tile) this.byPort.set(port, (tile = newTile(port)));
    return tile;
  }

  /** @param {StreamEvent} event @param {Tile} tile */
  takeOfTile(event, tile) {
    this.dirty.add(tile.port);
    if (event.place !== undefined) {
      this.lay(tile, event.place);
      if (!event.place) this.show(tile, event.time, "");
    } else if (event.open !== undefined) {
      tile.powered = event.open;
      tile.countSide = -1;
      this.version++;
      this.isMoved = true;
      if (!event.open) {
        this.show(tile, event.time, "");
        Object.assign(tile, { updates: 0, margin: null, state: [], links: "----" });
      }
    } else if (event.cable !== undefined) {
      const end = `${tile.port} ${event.side}`;
      if (event.cable === "cut") this.cut.add(end);
      else this.cut.delete(end);
      this.isMoved = true;
    } else if (event.display) {
      Object.assign(tile, event.display);
    } else if (event.frame !== undefined) {
      this.takeFrame(tile, SIDES.indexOf(event.side ?? ""), event.frame);
    } else if (event.raw !== undefined) {
      this.takeSentence(tile, event.time, event.raw);
    }
  }

  /** @param {Tile} tile @param {Place | null} place */
  lay(tile, place) {
    if (tile.place && this.byPlace.get(tile.place.join()) === tile) this.byPlace.delete(tile.place.join());
    if (place) this.byPlace.set(place.join(), tile);
    tile.place = place;
    this.version++;
    this.isMoved = true;
  }

  /** @param {Tile} tile @param {number} side @param {string} hex */
  takeFrame(tile, side, hex) {
    this.pulses.push({ from: tile.port, side, bytes: hex.length / 2 });
    const frame = parseFrame(hex);
    if (!frame || !tile.powered) return;
    tile.state = frame.state;
    // Telemetry tells the number of updates now and then; frames leave after each one, the first at boot.
    if (tile.countSide < 0) tile.countSide = side;
    else if (tile.countSide === side && !tile.frozen) tile.updates++;
  }

  /** @param {Tile} tile @param {number} time @param {string} raw */
  takeSentence(tile, time, raw) {
    const sentence = parseSentence(raw);
    switch (sentence?.name) {
      case "HELLO":
        Object.assign(tile, {
          modelId: sentence.modelId, channels: sentence.channels, classes: sentence.classes,
          periodMs: sentence.periodMs, frozen: sentence.updates > 0, updates: 0, margin: null, error: "",
        });
        this.show(tile, time, "");
        break;
      case "TILE":
        tile.updates = sentence.updates;
        tile.uptimeMs = sentence.uptimeMs;
        tile.margin = sentence.margin;
        tile.links = sentence.links;
        tile.state = sentence.state;
        this.show(tile, time, sentence.label);
        break;
      case "LINK":
        tile.link[sentence.side] = sentence;
        break;
      case "TIME":
        tile.time = sentence;
        break;
      case "BOARD":
        tile.board = sentence;
        break;
      case "ERROR":
        tile.error = `${sentence.code}: ${sentence.text}`;
        break;
      case "ACK":
        if (sentence.fields[0] === "SET" && sentence.fields[1] === "updates") {
          tile.frozen = sentence.fields[2] !== "0";
        }
        break;
    }
  }

  /** @param {Tile} tile @param {number} time @param {string} label */
  show(tile, time, label) {
    if (label === tile.label) return;
    this.history.note({ time, port: tile.port, from: tile.label, to: label });
    tile.label = label;
    this.version++;
  }

  /** The labels of the tiles on the board that have power, and how many show each. */
  count() {
    /** @type {Map<string, number>} */
    const counts = new Map();
    let total = 0;
    for (const tile of this.byPort.values()) {
      if (!tile.place || !tile.powered) continue;
      total++;
      counts.set(tile.label, (counts.get(tile.label) ?? 0) + 1);
    }
    return { counts, total };
  }

  /** Tiles on the board, in reading order. @returns {LaidTile[]} */
  laid() {
    const laid = /** @type {LaidTile[]} */ ([...this.byPort.values()].filter((tile) => tile.place));
    return laid.sort((a, b) => a.place[0] - b.place[0] || a.place[1] - b.place[1]);
  }

  /** @param {number} row @param {number} col @returns {Tile | undefined} */
  at(row, col) {
    return this.byPlace.get(`${row},${col}`);
  }

  /** @param {Tile} tile @param {number} side */
  neighbour(tile, side) {
    if (!tile.place) return undefined;
    return this.at(tile.place[0] + OFFSETS[side][0], tile.place[1] + OFFSETS[side][1]);
  }

  /** Whether the cable at a side of a tile is cut. @param {Tile} tile @param {number} side */
  isCut(tile, side) {
    const other = this.neighbour(tile, side);
    return this.cut.has(`${tile.port} ${SIDES[side]}`) ||
      (other !== undefined && this.cut.has(`${other.port} ${SIDES[(side + 2) % 4]}`));
  }

  /** The look of a label; a dark one where it is none. @param {string} label @returns {Look} */
  look(label) {
    return this.looks.find((look) => look.label === label) ?? { label, segments: 0, rgb: [0, 0, 0] };
  }
}
