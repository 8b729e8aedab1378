// The run on the page: what it began with, what hands have changed since, and the address that says so.

/** @import { Command } from "./source.js" */
/** @import { Start } from "./address.js" */
/** @import { Tiles } from "./tiles.js" */
import { readAddress, writeAddress } from "./address.js";
import { known } from "./drawing.js";
import { MOST_DEEDS, MOST_TEXT } from "./deeds.js";
import { faultsNow, kindsChangedBy, lossOf } from "./faults.js";

export const TOO_MUCH = "Too much was done for a link: it is that of the board as it lies now. Save a recording instead.";

const SLACK_S = 0.002; // times of an address are round
// What empties the board on which a run without tiles begins.
/** @type {Command} */
const FIRST_PULLED = { do: "pull", port: "tile-01" };

// What of an address is no part of the run.
const KEPT = ["embed", "lesson", "look"];

/** What the address says of these, as its end. @param {...string} names */
function kept(...names) {
  const given = new URLSearchParams(location.search);
  return names.filter((name) => given.has(name)).map((name) => `&${name}=${encodeURIComponent(given.get(name) ?? "")}`).join("");
}

export class Run {
  /** @param {Tiles} tiles @param {(command: Command) => void} send to the source */
  constructor(tiles, send) {
    this.tiles = tiles;
    this.send = send;
    /** What it would begin with now. @type {Start | null} */
    this.start = null;
    /** What it began with. @type {Start | null} */
    this.opened = null;
    /** The faults that it was given at its start, and the kinds of it that a hand has changed since. @type {string[]} */
    this.given = [];
    /** @type {Set<string>} */
    this.handled = new Set();
    this.noise = 0;
    /** Whether it began as usual, since what the address asks for cannot be. */
    this.isUsual = false;
    /** The model that the address was opened with, until it is told or another one is chosen. */
    this.wantedModel = new URLSearchParams(location.search).get("model") ?? "";
    /** The runs that were there before it was asked for; until there is one more, the tiles are those of another. */
    this.runsBefore = 0;
  }

  /** Whether it can begin anew: real tiles cannot. */
  get isOwn() {
    return this.tiles.can("arrange");
  }

  /** Whether the tiles on the page are its own. */
  get hasBegun() {
    return this.tiles.runs > this.runsBefore;
  }

  /** Until when it does what other hands did, where it is one of a link; else null. */
  get sharedEnd() {
    const { deeds, until } = this.opened ?? { deeds: [], until: null };
    return deeds.length ? until ?? deeds[deeds.length - 1].time : null;
  }

  /** Whether those other hands have something to do yet. */
  get isBeforeEnd() {
    return this.sharedEnd !== null && this.tiles.time < this.sharedEnd - SLACK_S;
  }

  /** A hand does something. @param {Command} command */
  note(command) {
    for (const kind of kindsChangedBy(command)) this.handled.add(kind);
    if (command.do === "noise") this.noise = Number(command.loss);
    if (command.do === "pace" && this.start) this.start.speed = Number(command.speed);
  }

  /** Time has gone to another moment: the share of bytes that was lost then. */
  noiseNow() {
    const { tiles } = this;
    const last = tiles.deeds.findLast(({ time, deed }) => time <= tiles.time && deed.do === "noise");
    return (this.noise = last ? Number(last.deed.loss) || 0 : lossOf(this.given));
  }

  /** Begins what the address asks for. */
  begin() {
    this.start = this.start ?? readAddress(location.search, this.tiles.drawings);
    const isOfReal = this.tiles.kind === "watched"; // they are slow enough as they are
    if (isOfReal && !new URLSearchParams(location.search).has("speed")) this.start.speed = 1;
    this.open(this.start);
  }

  /** @param {Start} wanted */
  open(wanted) {
    this.start = wanted;
    this.runsBefore = this.tiles.runs;
    this.given = wanted.faults;
    this.opened = { ...wanted };
    this.handled.clear();
    for (const { deed } of wanted.deeds) for (const kind of kindsChangedBy(deed)) this.handled.add(kind);
    this.noise = lossOf(wanted.faults);
    const { cells, seed, speed, faults, spread, until } = wanted;
    const planned = wanted.deeds.map(({ time, deed }) => [time, deed]);
    if (!cells.length) planned.unshift([0, FIRST_PULLED]); // a run needs a tile
    this.send({ do: "open", cells: cells.length ? cells : [[0, 0]], seed, speed, faults, spread_s: spread, until_s: until, deeds: planned });
  }

  /** Begins again with what lies on the board now. */
  restart() {
    if (!this.start) return;
    this.remember();
    this.open({ ...this.start, until: null, deeds: [] });
  }

  /** Begins again without what an address asks for and cannot be: its faults and deeds, or else all of it. */
  withoutRefused() {
    if (!this.start || this.isUsual) return;
    const { faults, deeds } = this.start;
    this.isUsual = faults.length + deeds.length === 0;
    const start = this.isUsual ? readAddress("", this.tiles.drawings) : this.start;
    this.open({ ...start, faults: [], deeds: [] });
  }

  /** The query of the address of a run that begins with the board as it is now. */
  linkNow() {
    if (!this.start || !this.isOwn) return location.search;
    this.remember();
    return writeAddress({ ...this.start, until: null, deeds: [] }, this.tiles.drawings) + kept("look");
  }

  /**
   * The query of the address of the run as it was, with all that hands did; null where that is too much.
   * @param {number} end until when, in seconds
   */
  link(end = this.tiles.time) {
    const { tiles, opened } = this;
    if (!opened || !this.isOwn) return location.search;
    const until = Number(end.toFixed(6));
    const own = opened.cells.length ? tiles.deeds : tiles.deeds.slice(1); // the first is that of an empty board
    const deeds = own.filter(({ time }) => time <= until);
    const run = { ...opened, speed: this.start?.speed ?? opened.speed, model: this.start?.model ?? "", until, deeds };
    if (deeds.length > MOST_DEEDS || JSON.stringify(run).length > MOST_TEXT) return null;
    return writeAddress(run, tiles.drawings) + kept("look");
  }

  /** Notes what lies on the board now, in `start` and in the address; returns the name of the drawing, or "". */
  remember() {
    const { tiles, start } = this;
    const laid = tiles.laid();
    if (!start || !this.hasBegun || !this.isOwn) return "";
    start.cells = laid.map((tile) => tile.place);
    const isUp = tiles.time > start.spread + 0.1;
    if (isUp) start.faults = faultsNow(tiles, this.given, this.handled, this.noise);
    const name = known(start.cells, tiles.drawings)?.name ?? "";
    if (this.isBeforeEnd) return name; // a reload shows it again
    if (this.sharedEnd !== null) start.until = null;
    const address = writeAddress({ ...start, deeds: [] }, tiles.drawings) + kept(...KEPT);
    if (address !== location.search) history.replaceState(null, "", address + location.hash);
    return name;
  }

  /** Notes the tiles' model; returns the one that the address was opened with, where it is another. */
  otherModel() {
    const modelId = this.tiles.laid().find((tile) => tile.modelId)?.modelId;
    if (!this.start || !modelId || !this.hasBegun) return "";
    const wanted = this.wantedModel;
    this.wantedModel = "";
    this.start.model = modelId;
    return [modelId, this.tiles.model].includes(wanted) ? "" : wanted;
  }
}
