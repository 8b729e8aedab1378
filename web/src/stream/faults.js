// The faults of `tilenca emulate --fault`, and their times: the twin of `tilenca.emulator.faults`, which says how they
// are written.
import { TilencaError } from "../module.js";
import { Chance } from "./chance.js";
import { SIDES } from "./sides.js";

const EXAMPLE = "loss=0.1@3E:2-5 or cut@3-4:2";
/** With the most each can be. */
const LINK_KINDS = new Map([["loss", 1], ["flip", 1], ["delay", 1000]]);
const TILE_KINDS = new Map([["drift", 10000], ["adc", 100], ["supply", 5.5], ["skew", 100_000]]);
const SIGNED_KINDS = ["skew"];
const LEAST_V = 1.8, USUAL_V = 5, MOMENT_KINDS = ["cut", "off", "remove", "reset", "turn"];
const ENDLESS = ["remove", "reset", "adc", "drift"];
const SHAPE = /^([a-z]+)(?:=([^@:]+))?(?:@([^:]+))?(?::([^-]+)(?:-(.+))?)?$/;
const NUMBER = /^\s*[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?\s*$/i;

/**
 * One direction: the tile, counted from 0, and the side that it leaves.
 * @typedef {readonly [number, number]} End
 * @typedef {import("../array.js").Link} Link
 * @typedef {{ text: string, kind: string, value: number, where: string, fromS: number, toS: number | null }} Spec
 */

/** @param {string} text @param {string} fact */
const complaint = (text, fact) => new TilencaError(`--fault '${text}': ${fact}; for example ${EXAMPLE}`);

/** @param {string} text @param {string} part @param {string} fact @param {boolean} [isSigned] */
function numberIn(text, part, fact, isSigned = false) {
  const value = NUMBER.test(part) ? Number(part) : NaN;
  if (!Number.isFinite(value) || (value < 0 && !isSigned)) throw complaint(text, `'${part}' is no ${fact}`);
  return value;
}

/**
 * @param {string} text
 * @returns {Spec}
 * @throws {TilencaError} it is not valid; the message says why
 */
export function parseFault(text) {
  const match = SHAPE.exec(text);
  const kinds = [...LINK_KINDS.keys(), ...MOMENT_KINDS, ...TILE_KINDS.keys()];
  const word = /^[a-z]*/.exec(text)?.[0] ?? "";
  if (!kinds.includes(word)) throw complaint(text, `it begins with none of ${kinds.join(", ")}`);
  if (match === null) {
    throw complaint(text, `after ${word} comes [=VALUE][@WHERE][:FROM[-TO]], times in seconds from 0`);
  }
  const [, kind, valueText, where, fromText, toText] = match;
  const most = LINK_KINDS.get(kind) ?? TILE_KINDS.get(kind);
  if ((most === undefined) !== (valueText === undefined)) {
    throw complaint(text, `${kind} takes ${most === undefined ? "no" : "a"} number`);
  }
  const isSigned = SIGNED_KINDS.includes(kind);
  const value = valueText === undefined ? 0 : numberIn(text, valueText, "number", isSigned);
  if (most !== undefined && Math.abs(value) > most) throw complaint(text, `${kind} is ${isSigned ? -most : 0} to ${most}`);
  if (kind === "supply" && value < LEAST_V) throw complaint(text, `supply is ${LEAST_V} to ${most} V`);
  const fromS = fromText === undefined ? 0 : numberIn(text, fromText, "time in seconds");
  const toS = toText === undefined ? null : numberIn(text, toText, "time in seconds");
  if (toS !== null && toS <= fromS) throw complaint(text, "it ends before it begins");
  if (toS !== null && ENDLESS.includes(kind)) throw complaint(text, `${kind} has no end`);
  if (MOMENT_KINDS.includes(kind) && where === undefined) throw complaint(text, `${kind} needs a place`);
  return { text, kind, value, where: where ?? "", fromS, toS };
}

/** @param {() => void} act what may find that a cable or a tile has gone */
export function ifThere(act) {
  try {
    act();
  } catch (error) {
    if (!(error instanceof TilencaError)) throw error;
  }
}

/** The faults of one array: injects each at its time. */
export class Faults {
  /** The ends at which cables are cut now, "tile,side". @type {Set<string>} */
  cut = new Set();
  /** The tiles that lie turned by 90 degrees now. @type {Set<number>} */
  turned = new Set();
  /** By how much the clocks of tiles are too fast now, in ppm. @type {Map<number, number>} */
  skewed = new Map();
  /** When each tile was switched on or reset last, of those that were. @type {Map<number, number>} */
  restarted = new Map();
  /** What all cables have now. @type {Map<string, number>} */
  #everywhere = new Map();
  /** @type {{ timeS: number, order: number, act: () => void }[]} */
  #due = [];
  /** @type {Map<string, Map<string, number>>} */
  #spoilt = new Map();

  /**
   * @param {import("../array.js").TileArray} array
   * @param {Link[]} links the cables, which come and go
   * @param {number} seed
   */
  constructor(array, links, seed) {
    this.array = array;
    this.links = links;
    this.seed = seed;
  }

  /** A copy of all that is planned and stands. */
  save() {
    const spoilt = new Map([...this.#spoilt].map(([end, kinds]) => [end, new Map(kinds)]));
    return {
      cut: new Set(this.cut), turned: new Set(this.turned), skewed: new Map(this.skewed), restarted: new Map(this.restarted),
      everywhere: new Map(this.#everywhere), due: [...this.#due], spoilt,
    };
  }

  /** Knows again what a copy says; the array's own snapshot has the faults themselves. @param {ReturnType<Faults["save"]>} moment */
  restore(moment) {
    this.cut = new Set(moment.cut);
    this.turned = new Set(moment.turned);
    this.skewed = new Map(moment.skewed);
    this.restarted = new Map(moment.restarted);
    this.#everywhere = new Map(moment.everywhere);
    this.#due = [...moment.due];
    this.#spoilt = new Map([...moment.spoilt].map(([end, kinds]) => [end, new Map(kinds)]));
  }

  /** Plans a fault. @param {Spec} spec @throws {TilencaError} there is no such tile or cable */
  add(spec) {
    const { kind, where } = spec;
    if (LINK_KINDS.has(kind)) {
      const ends = this.#ends(spec);
      const setTo = (/** @type {boolean} */ on) => {
        const value = on ? spec.value : 0;
        if (where) this.#spoil(ends, kind, value);
        else this.spoilAll(kind, value);
      };
      this.#planSwitch(spec, [setTo], true);
    } else if (kind === "cut") {
      this.#planSwitch(spec, this.#ends(spec).map((end) => (on) => this.connect(end, on)), false);
    } else if (kind === "off") {
      this.#planSwitch(spec, this.#tiles(spec).map((tile) => (/** @type {boolean} */ on) => this.power(tile, on)), false);
    } else if (kind === "turn") {
      this.#planSwitch(spec, this.#tiles(spec).map((tile) => (/** @type {boolean} */ on) => this.turn(tile, on)), true);
    } else {
      for (const tile of this.#tiles(spec)) {
        this.#plan(spec.fromS, () => this.#act(spec, tile));
        if (spec.toS !== null) this.#plan(spec.toS, () => this.#end(kind, tile));
      }
    }
  }

  /** @param {number} timeS @param {() => void} act */
  #plan(timeS, act) {
    const order = this.#due.length;
    const later = this.#due.findIndex((due) => due.timeS > timeS || (due.timeS === timeS && due.order > order));
    this.#due.splice(later < 0 ? order : later, 0, { timeS, order, act });
  }

  /** @param {Spec} spec @param {((on: boolean) => void)[]} switches @param {boolean} first */
  #planSwitch(spec, switches, first) {
    for (const turn of switches) {
      this.#plan(spec.fromS, () => turn(first));
      if (spec.toS !== null) this.#plan(spec.toS, () => turn(!first));
    }
  }

  /** @param {Spec} spec @param {number} index */
  #act(spec, index) {
    const tile = this.array.tile(index);
    if (spec.kind === "reset") this.reset(index);
    else if (spec.kind === "remove") this.array.removeTile(index);
    else if (spec.kind === "adc") tile.setAdcNoise(spec.value, this.seed);
    else if (spec.kind === "supply") tile.setSupply(spec.value);
    else {
      const rate = spec.value * (spec.where ? 1 : new Chance(`${this.seed} ${spec.kind} ${index}`).uniform(-1, 1));
      if (spec.kind === "skew") this.skew(index, rate);
      else tile.setDrift(rate);
    }
  }

  /** Ends a fault of tiles that has an end. @param {string} kind @param {number} tile */
  #end(kind, tile) {
    if (kind === "skew") this.skew(tile, 0);
    else this.array.tile(tile).setSupply(USUAL_V);
  }

  /** Runs the array for a while, and injects the faults that fall due. @param {number} seconds */
  run(seconds) {
    const endS = this.array.timeS + seconds;
    for (let due = this.#due[0]; due !== undefined && due.timeS <= endS; due = this.#due[0]) {
      this.#due.shift();
      if (due.timeS > this.array.timeS) this.array.run(due.timeS - this.array.timeS);
      due.act();
    }
    if (endS > this.array.timeS) this.array.run(endS - this.array.timeS);
  }

  /** The time of the next one that is planned. */
  get nextS() {
    return this.#due[0]?.timeS ?? Infinity;
  }

  // --- what they do ---

  /** Switches a tile on or off. @param {number} tile @param {boolean} on */
  power(tile, on) {
    this.array.tile(tile).powered = on;
    if (on) this.restarted.set(tile, this.array.timeS);
  }

  /** Starts a tile's program anew, as its reset pin does. @param {number} tile */
  reset(tile) {
    this.array.tile(tile).reset();
    this.restarted.set(tile, this.array.timeS);
  }

  /** @param {readonly End[]} ends @param {string} kind @param {number} value */
  #spoil(ends, kind, value) {
    for (const [tile, side] of ends) {
      const spoilt = this.#spoilt.get(`${tile},${side}`) ?? new Map();
      this.#spoilt.set(`${tile},${side}`, spoilt.set(kind, value));
      const fault = {
        loss: spoilt.get("loss") ?? 0, flip: spoilt.get("flip") ?? 0, delayS: (spoilt.get("delay") ?? 0) / 1000,
      };
      ifThere(() => this.array.setFault(tile, side, fault, this.seed));
    }
  }

  /** Sets one of the faults of links on all cables, and on those that come later. @param {string} kind @param {number} value */
  spoilAll(kind, value) {
    this.#everywhere.set(kind, value);
    this.#spoil(sorted(this.links.flatMap(endsOf)), kind, value);
  }

  /** A new cable: it has the faults that all cables have now, and no other. @param {Link} link */
  plugIn(link) {
    for (const end of endsOf(link)) this.#spoilt.delete(end.join());
    for (const [kind, value] of this.#everywhere) this.#spoil(endsOf(link), kind, value);
    this.#join(link);
  }

  /** Cuts the cable at an end, or mends it. @param {End} end @param {boolean} on */
  connect([tile, side], on) {
    for (const link of this.links) {
      if (!endsOf(link).some(([one, at]) => one === tile && at === side)) continue;
      this.cut[on ? "delete" : "add"](`${tile},${side}`);
      this.#join(link);
    }
  }

  /** Turns a tile by 90 degrees, or back. @param {number} tile @param {boolean} on */
  turn(tile, on) {
    this.turned[on ? "add" : "delete"](tile);
    for (const link of this.links) if (link[0] === tile || link[2] === tile) this.#join(link);
  }

  /** From now on a tile's clock is so much faster than it was made. @param {number} tile @param {number} ppm */
  skew(tile, ppm) {
    this.array.tile(tile).setSkew(ppm);
    this.skewed.set(tile, ppm);
  }

  /** Lets a cable carry bytes, unless it is cut or one of its tiles is turned. @param {Link} link */
  #join(link) {
    const isWhole = !endsOf(link).some((end) => this.cut.has(end.join())) && !this.turned.has(link[0]) && !this.turned.has(link[2]);
    ifThere(() => (isWhole ? this.array.mend(link[0], link[1]) : this.array.cut(link[0], link[1])));
  }

  // --- where they do it ---

  /** @param {Spec} spec */
  #tiles(spec) {
    return spec.where ? [this.#tile(spec, spec.where)] : Array.from({ length: this.array.size }, (_, tile) => tile);
  }

  /** @param {Spec} spec @param {string} text */
  #tile(spec, text) {
    if (!/^\d+$/.test(text) || Number(text) < 1 || Number(text) > this.array.size) {
      throw complaint(spec.text, `no tile '${text}'; they are 1 to ${this.array.size}, from left to right and top to bottom`);
    }
    return Number(text) - 1;
  }

  /** @param {Spec} spec */
  #ends(spec) {
    const { where } = spec;
    const both = this.links.flatMap((link) => [link, turned(link)]);
    const [one, two] = where.split(/-(.*)/s);
    let wanted = (/** @type {Link} */ _) => true;
    if (two !== undefined) {
      const [a, b] = [this.#tile(spec, one), this.#tile(spec, two)];
      wanted = ([tile, , other]) => (tile === a && other === b) || (tile === b && other === a);
    } else if (where && SIDES.includes(where.slice(-1))) {
      const [a, at] = [this.#tile(spec, where.slice(0, -1)), SIDES.indexOf(where.slice(-1))];
      wanted = ([tile, side]) => tile === a && side === at;
    } else if (where) {
      const a = this.#tile(spec, where);
      wanted = ([tile, , other]) => tile === a || other === a;
    }
    const ends = both.filter(wanted).map(([tile, side]) => /** @type {End} */ ([tile, side]));
    if (ends.length === 0 && where) {
      const tile = this.#tile(spec, one.replace(/[NESW]+$/, ""));
      const there = sorted(both.filter(([a]) => a === tile).map(([, side, other]) => [side, other]));
      const cables = there.map(([side, other]) => `${SIDES[side]} to tile ${other + 1}`).join(", ");
      throw complaint(spec.text, `no cable there; tile ${tile + 1} has ${cables || "none"}`);
    }
    return sorted(ends);
  }
}

/** The same cable from its other end. @param {Link} link @returns {Link} */
export const turned = ([tile, side, other, otherSide]) => [other, otherSide, tile, side];

/** @param {Link} link @returns {End[]} */
export const endsOf = ([tile, side, other, otherSide]) => [[tile, side], [other, otherSide]];

/** @template {readonly number[]} T @param {T[]} lists of numbers, all as long @returns {T[]} in their order */
export function sorted(lists) {
  return [...lists].sort((one, other) => {
    const place = one.findIndex((number, index) => number !== other[index]);
    return place < 0 ? 0 : one[place] - other[place];
  });
}
