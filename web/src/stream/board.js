// Emulated tiles in the places of a board, rearranged by hand while they run: the twin of
// `tilenca.emulator.arrangement`, and of the beginning of a run in `tilenca.emulator.experiment`.
import { TilencaError } from "../module.js";
import { EAST, SOUTH } from "../sides.js";
import { Chance } from "./chance.js";
import { MAX_PLACE } from "./commands.js";
import { Faults, endsOf, parseFault } from "./faults.js";
import { setCommand, settingsBlock } from "./settings.js";
import { OFFSETS, OPPOSITE, SIDES } from "./sides.js";
import { Traffic } from "./traffic.js";

const PPM = 3000; // clock errors are up to so much
// A tile stops at its number of updates: at once, where it has done more.
const STOPPED_UPDATES = 1;
const FOR_EVER = 0;

/** @typedef {import("../array.js").Link} Link */
/** @typedef {readonly [number, number]} Place row and column, any whole numbers */

/**
 * @typedef {object} Run
 * @property {import("../array.js").Image} image
 * @property {string} name of the drawing, which the chance of a run depends on
 * @property {readonly Place[]} cells in reading order
 * @property {number} seed
 * @property {readonly string[]} faults
 * @property {number} spreadS
 * @property {number | null} periodMs for the tiles' settings; null: they get none
 * @property {number} updates of the same
 */

/** @param {Place} one @param {Place} other */
const isSame = (one, other) => one[0] === other[0] && one[1] === other[1];

/** Which tile lies where, and what a hand may do about it. A tile that is taken out lies in the box. */
export class Board {
  /** Of the tiles on the board, by their index. @type {Map<number, Place>} */
  places;
  /** @type {Link[]} */
  cables = [];

  /**
   * @param {import("../emulator.js").Emulator} emulator
   * @param {Run} run
   * @throws {TilencaError} a fault names a tile or a cable that does not exist
   */
  constructor(emulator, run) {
    this.run = run;
    const count = run.cells.length;
    const specs = run.faults.map(parseFault);
    this.places = new Map(run.cells.map((place, tile) => [tile, place]));
    for (const [tile, place] of this.places) {
      for (const side of [EAST, SOUTH]) {
        const other = this.tileAt(beside(place, side));
        if (other !== undefined) this.cables.push([tile, side, other, OPPOSITE[side]]);
      }
    }
    const chance = new Chance(`${run.seed} ${run.name}`);
    const ppm = run.cells.map(() => chance.uniform(-PPM, PPM));
    const switchOnS = run.cells.map(() => chance.uniform(0, run.spreadS));
    const hardware = { seed: chance.bits(63) };
    this.array = emulator.array({ image: run.image, tiles: count, links: this.cables, ppm, switchOnS, hardware });
    try {
      this.faults = new Faults(this.array, this.cables, run.seed);
      for (const spec of specs) this.faults.add(spec);
      for (let tile = 0; tile < count; tile++) this.#writeSettings(tile, run.updates);
      this.traffic = new Traffic(this.array);
      for (const cable of this.cables) this.traffic.watch(cable);
    } catch (error) {
      this.array.free();
      throw error;
    }
  }

  /** @param {number} tile @param {number} updates */
  #writeSettings(tile, updates) {
    const { periodMs } = this.run;
    if (periodMs !== null) this.array.tile(tile).writeEeprom(0, settingsBlock(tile + 1, periodMs, updates));
  }

  /** The tile that lies there. @param {Place} place @returns {number | undefined} */
  tileAt(place) {
    for (const [tile, other] of this.places) if (isSame(place, other)) return tile;
    return undefined;
  }

  /** The cables that are cut now. */
  get cut() {
    return this.cables.filter((link) => endsOf(link).some((end) => this.faults.cut.has(end.join())));
  }

  // --- what a hand does ---

  /** Plugs a tile in at a place, and switches it on. @param {Place} place */
  put(place) {
    if (this.tileAt(place) !== undefined) throw new TilencaError("another tile lies there; choose an empty place");
    let tile = 0;
    while (tile < this.array.size && this.places.has(tile)) tile++;
    if (tile === this.array.size) this.array.addTile(new Chance(`${this.run.seed} tile ${tile}`).uniform(-PPM, PPM));
    this.#writeSettings(tile, FOR_EVER);
    this.faults.power(tile, true);
    this.#plugIn(tile, place);
  }

  /** Takes a tile away, with its cables. @param {number} tile */
  pull(tile) {
    this.#unplug(this.cables.filter(([one, , other]) => one === tile || other === tile));
    this.faults.power(tile, false);
    this.faults.turn(tile, false);
    this.places.delete(tile);
  }

  /** Takes a tile out and plugs it in elsewhere: it boots there. @param {number} tile @param {Place} place */
  move(tile, place) {
    const there = this.tileAt(place);
    if (there === tile) return;
    if (there !== undefined) throw new TilencaError("another tile lies there; choose an empty place");
    this.pull(tile);
    this.faults.power(tile, true);
    this.#plugIn(tile, place);
  }

  /** Moves tiles together: they keep their power and the cables between them, and run on. @param {number[]} tiles @param {number} rows @param {number} cols */
  shift(tiles, rows, cols) {
    const there = new Map(tiles.map((tile) => {
      const [row, col] = /** @type {Place} */ (this.places.get(tile));
      return [tile, /** @type {Place} */ ([row + rows, col + cols])];
    }));
    for (const place of there.values()) {
      const other = this.tileAt(place);
      if (other !== undefined && !there.has(other)) throw new TilencaError("other tiles lie there; choose empty places");
    }
    if ([...there.values()].flat().some((number) => Math.abs(number) > MAX_PLACE)) {
      throw new TilencaError(`the board ends there; rows and columns are -${MAX_PLACE} to ${MAX_PLACE}`);
    }
    this.#unplug(this.cables.filter(([one, , other]) => there.has(one) !== there.has(other)));
    for (const [tile, place] of there) this.places.set(tile, place);
    for (const tile of [...there.keys()].sort((one, other) => one - other)) this.#join(tile, there);
  }

  /** Makes another drawing of the running tiles. @param {readonly Place[]} cells in reading order */
  arrange(cells) {
    for (const [tile, place] of [...this.places]) if (!cells.some((cell) => isSame(cell, place))) this.pull(tile);
    for (const place of cells) if (this.tileAt(place) === undefined) this.put(place);
  }

  /** Tells a tile over USB to update no more, or for ever. @param {number} tile @param {boolean} on */
  freeze(tile, on) {
    this.tell(tile, setCommand("updates", on ? STOPPED_UPDATES : FOR_EVER));
  }

  /** Sends a tile a command over USB. @param {number} tile @param {string} command */
  tell(tile, command) {
    this.array.tile(tile).send(command);
  }

  /** Cuts or mends the cable at a side. @param {number} tile @param {number} side @param {boolean} isWhole */
  connect(tile, side, isWhole) {
    const isHere = (/** @type {Link} */ link) => endsOf(link).some(([one, at]) => one === tile && at === side);
    const link = this.cables.find(isHere);
    if (link === undefined) throw new TilencaError(`tile ${tile + 1} has no neighbour in the ${SIDES[side]}`);
    if (isWhole) this.faults.cut.delete(`${link[2]},${link[3]}`); // a fault may have named its other end
    this.faults.connect([link[0], link[1]], isWhole);
  }

  // --- moments ---

  /** The board as it is now. */
  save() {
    const { array, places, cables, faults } = this;
    return {
      timeS: array.timeS, snapshot: array.save().slice(), places: new Map(places), cables: [...cables], faults: faults.save(),
    };
  }

  /** Goes to a moment of this board; from there the same happens as did then. @param {ReturnType<Board["save"]>} moment */
  restore(moment) {
    this.array.restore(moment.snapshot);
    this.places = new Map(moment.places);
    this.cables.splice(0, Infinity, ...moment.cables); // the faults know this list, too
    this.faults.restore(moment.faults);
    this.traffic.restart(moment.cables);
  }

  /** @param {readonly Link[]} links */
  #unplug(links) {
    for (const link of links) {
      this.array.unlink(link[0], link[1]);
      this.traffic.forget(link);
      this.cables.splice(this.cables.indexOf(link), 1);
      for (const end of endsOf(link)) this.faults.cut.delete(end.join());
    }
  }

  /** @param {number} tile @param {Place} place */
  #plugIn(tile, place) {
    this.places.set(tile, place);
    this.#join(tile, new Map());
  }

  /**
   * Plugs in the cables to its neighbours, but to those that are joined with it already.
   * @param {number} tile @param {Map<number, Place>} joined
   */
  #join(tile, joined) {
    const place = /** @type {Place} */ (this.places.get(tile));
    for (let side = 0; side < SIDES.length; side++) {
      const other = this.tileAt(beside(place, side));
      if (other === undefined || joined.has(other)) continue;
      /** @type {Link} */
      const link = side === EAST || side === SOUTH
        ? [tile, side, other, OPPOSITE[side]]
        : [other, OPPOSITE[side], tile, side];
      this.array.link(...link);
      this.cables.push(link);
      this.traffic.watch(link);
      this.faults.plugIn(link);
    }
  }
}

/** @param {Place} place @param {number} side @returns {Place} */
const beside = (place, side) => [place[0] + OFFSETS[side][0], place[1] + OFFSETS[side][1]];
