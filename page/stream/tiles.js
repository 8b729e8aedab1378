// What the page knows of the tiles: the stream's events, added up.

/** @import { Drawing, Look, Model, Place, StreamEvent } from "./source.js" */
/** @import { LaidTile, Tile } from "./tile.js" */
import { parseFrame } from "./frames.js";
import { parseSentence } from "./sentences.js";
import { History } from "./history.js";
import { OFFSETS, SIDES, STREAM_VERSION } from "./source.js";
import { forget, hear, newTile } from "./tile.js";

/** @typedef {{from: string, side: number, bytes: number}} Pulse */
/** A line of the log. @typedef {{time: number, port: string, text: string, bad: boolean}} Note */

const MOST_NOTES = 200;

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
    /** Those that one can choose from, and the name of the one that runs. @type {Model[]} */
    this.models = [];
    this.model = "";
    /** What they are: "emulated", "watched", or a "recording"; "building" or "failed": their firmware is not there. */
    this.source = "";
    /** Why it has failed. */
    this.reason = "";
    /** Of a recording, what was recorded; else the same. */
    this.kind = "";
    /** The commands that the source takes; null: all of them. @type {Set<string> | null} */
    this.takes = null;
    /** The log of real tiles, the latest line last. @type {Note[]} */
    this.notes = [];
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
    /** The time 0 of real tiles, in seconds since 1970. */
    this.began = 0;
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
      if (this.version !== before) this.history.sample({ time: event.time, ...this.count((tile) => tile.label) });
    }
  }

  /** @param {StreamEvent} event */
  takeOne(event) {
    if (event.stream !== undefined) {
      if (event.stream !== STREAM_VERSION) this.refused = `The server speaks version ${event.stream}: reload the page.`;
      this.source = event.source ?? "";
      this.kind = event.of ?? this.source;
      this.reason = event.reason ?? "";
      this.version++; // the verdict is on these tiles
      this.takes = event.takes ? new Set(event.takes) : null;
      this.looks = event.looks ?? [];
      this.drawings = event.drawings ?? [];
      this.models = event.models ?? [];
      this.model = event.model ?? "";
      this.mostTiles = event.most_tiles ?? 0;
      this.mostPlace = event.most_place ?? 0;
      this.stepS = (event.period_ms ?? 20) / 1000;
    } else if (event.run) {
      this.begin(event.run);
    } else if (event.deed) {
      this.deeds = [...this.deeds.filter(({ time }) => time <= event.time), { time: event.time, deed: event.deed }];
    } else if (event.jump) {
      this.jump(event.time);
      if (event.jump.forget) this.deeds = this.deeds.filter(({ time }) => time <= event.time);
    } else if (event.pace) {
      this.pace = event.pace;
      this.time = event.time;
      this.end = event.pace.end ?? null;
      this.history.pass(event.time, event.pace.end);
    } else if (event.refused !== undefined) {
      this.refused = event.refused;
    } else if (event.classes) {
      this.looks = event.classes;
    } else if (event.port !== undefined) {
      this.takeOfTile(event, this.tile(event.port));
    }
  }

  /** @param {{seed: number, tiles: number, began?: number}} run */
  begin({ seed, tiles, began = 0 }) {
    this.jump(0);
    this.history = new History();
    this.deeds = [];
    this.notes = [];
    this.end = null;
    this.seed = seed;
    this.began = began;
    this.startTiles = tiles;
    this.runs++;
  }

  /** The run has gone to another time: what follows tells all that is there. @param {number} time */
  jump(time) {
    this.byPort.clear();
    this.byPlace.clear();
    this.cut.clear();
    this.pulses = [];
    this.notes = this.notes.filter((note) => note.time <= time);
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
      if (event.tile !== undefined) tile.number = event.tile;
      this.lay(tile, event.place);
      if (!event.place) {
        this.show(tile, event.time, "");
        forget(tile);
      }
    } else if (event.open !== undefined) {
      tile.powered = event.open;
      tile.reason = event.reason ?? "";
      tile.countSide = -1;
      this.version++;
      this.isMoved = true;
      if (!event.open) {
        this.show(tile, event.time, "");
        forget(tile);
      }
    } else if (event.cable !== undefined) {
      const end = `${tile.port} ${event.side}`;
      if (event.cable === "cut") this.cut.add(end);
      else this.cut.delete(end);
      this.isMoved = true;
    } else if (event.fault) {
      tile.turned = event.fault.turned;
      tile.skew = event.fault.skew;
      this.isMoved = true; // cables show it
    } else if (event.chip) {
      tile.chip = event.chip;
    } else if (event.display) {
      const { segments, rgb, leds } = event.display;
      if (segments !== tile.segments) this.version++;
      Object.assign(tile, { segments, rgb, leds });
    } else if (event.health) {
      if (tile.trouble !== event.health.trouble) this.version++;
      tile.trouble = event.health.trouble;
      tile.health = event.health.links;
      this.isMoved = true; // cables show it
    } else if (event.note !== undefined) {
      this.notes = [...this.notes.slice(1 - MOST_NOTES), { time: event.time, port: tile.port, text: event.note, bad: event.bad === true }];
    } else if (event.frame !== undefined) {
      this.takeFrame(tile, SIDES.indexOf(event.side ?? ""), event.frame);
    } else if (event.raw !== undefined) {
      this.takeSentence(tile, event);
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

  /** @param {Tile} tile @param {StreamEvent} event */
  takeSentence(tile, { time, raw = "", asked }) {
    const sentence = parseSentence(raw);
    const label = hear(tile, sentence, asked);
    if (label !== null) this.show(tile, time, label);
    if (sentence?.name !== "HELLO" || asked) return; // one that was asked for is no start
    forget(tile);
    this.show(tile, time, "");
  }

  /** @param {Tile} tile @param {number} time @param {string} label */
  show(tile, time, label) {
    if (label === tile.label) return;
    this.history.note({ time, port: tile.port, from: tile.label, to: label });
    tile.label = label;
    this.version++;
  }

  /** Whether the source takes a command. @param {string} name of it */
  can(name) {
    return this.takes === null || this.takes.has(name);
  }

  /** The label that a tile's face shows: it is some milliseconds ahead of what the tile says. @param {Tile} tile */
  shown(tile) {
    const isLit = tile.powered && tile.segments !== 0 && tile.rgb.some((part) => part > 0);
    const like = isLit ? this.looks.filter(({ segments }) => segments === tile.segments) : [];
    return like.length === 1 ? like[0].label : tile.label;
  }

  /** The labels of the tiles on the board that have power, and how many show each. @param {(tile: Tile) => string} labelOf */
  count(labelOf = (tile) => this.shown(tile)) {
    /** @type {Map<string, number>} */
    const counts = new Map();
    let total = 0;
    for (const tile of this.byPort.values()) {
      if (!tile.place || !tile.powered) continue;
      total++;
      const label = labelOf(tile);
      counts.set(label, (counts.get(label) ?? 0) + 1);
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

  /**
   * How the cable at a side of a tile is; at a turned tile it joins nothing. Real tiles do not tell that it is cut, but that they hear nobody.
   * @param {Tile} tile @param {number} side
   * @returns {"whole" | "failing" | "cut" | "turned"}
   */
  cableAt(tile, side) {
    if (this.isCut(tile, side)) return "cut";
    if (tile.turned || this.neighbour(tile, side)?.turned) return "turned";
    const marks = [tile.health[SIDES[side]], this.neighbour(tile, side)?.health[SIDES[(side + 2) % 4]]].map((one) => one?.[0]);
    if (marks.includes("dead") || marks.includes("foreign")) return "cut";
    return marks.includes("failing") ? "failing" : "whole";
  }

  /** The look of a label; a dark one where it is none. @param {string} label @returns {Look} */
  look(label) {
    return this.looks.find((look) => look.label === label) ?? { label, segments: 0, rgb: [0, 0, 0] };
  }
}
