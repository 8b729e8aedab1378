// The emulator behind the page: one run at a time, at any speed, with hands in it. The twin of
// `tilenca.page.emulated`: the same commands give the same events (docs/PROTOCOL.md section 7).
import { TilencaError } from "../module.js";
import { Board } from "./board.js";
import { checked } from "./commands.js";
import { sorted } from "./faults.js";
import { doByHand, tileOf } from "./hands.js";
import { Pace, QUANTUM_S } from "./pace.js";
import { Stepper } from "./stepper.js";
import { Teller, VOICE_BYTES, event, refused } from "./teller.js";
import { Timeline } from "./timeline.js";

// Up to this speed there is time to look at single frames on the cables.
const FRAMES_SPEED = 0.3;
const UNKNOWN = "-";
// An instruction after which a tile sleeps ends with its waking, which no planned fault may overtake.
const LONGEST_STEP_S = 0.1;

/** @typedef {import("./board.js").Place} Place */
/** @typedef {import("./commands.js").Command} Command */
/** @typedef {import("./teller.js").StreamEvent} StreamEvent */

/**
 * What the page is offered: made by `python -m release.page_bundle`.
 * @typedef {object} Offer
 * @property {StreamEvent & { drawings: { name: string, rows: string[] }[], model?: string, models?: { name: string, id: string }[] }} stream
 *   the first event
 * @property {number | null} period_ms of the image's settings
 * @property {number} updates of the same
 */

/** A board, and what its tiles have said until then. @typedef {{ board: ReturnType<Board["save"]>, said: ReturnType<Teller["save"]> }} Moment */

export class EmulatedSource {
  /** @type {Board | null} */
  #board = null;
  #pace = new Pace(1, true);
  #isResting = false;
  /** @type {StreamEvent[]} */
  #events = [];
  /** Of the board, as long as there is one. @type {Teller} */
  #teller = /** @type {any} */ (null);
  /** Of its array. @type {Stepper} */
  #stepper = /** @type {any} */ (null);
  /** @type {Timeline<Moment, Command>} */
  #timeline = new Timeline();

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
      case "instruct":
        this.#instruct(command.port, command.count);
        break;
      case "seek":
        this.#seek(command.seconds, command.forget);
        break;
      default:
        this.#layHandsOn(command);
    }
    if (this.#board) this.#events.push(...this.#teller.places());
  }

  /** @param {Command} command */
  #layHandsOn(command) {
    if (!this.#board) throw new TilencaError("nothing runs yet; open a drawing first");
    this.#release();
    doByHand(this.#board, command);
    this.#timeline.note(this.#board.array.timeS, command);
    this.#keep(this.#board);
    this.#tellPace(); // another future begins
    this.#tell(this.#board.array.timeS, { deed: command });
  }

  /**
   * What a hand does at its time; what cannot be done is told, and forgotten.
   * @param {Board} board @param {{ timeS: number, deed: Command }} planned
   */
  #doPlanned(board, planned) {
    try {
      doByHand(board, planned.deed);
    } catch (error) {
      if (!(error instanceof TilencaError)) throw error;
      this.#timeline.forget(planned);
      this.#events.push(refused(error.message));
    }
  }

  /** @param {string} port @param {number} count */
  #instruct(port, count) {
    const board = this.#board;
    if (!board) throw new TilencaError("nothing runs yet; open a drawing first");
    if (!this.#pace.paused) throw new TilencaError("single instructions are for a run that stands; pause it first");
    const { array } = board;
    const tile = tileOf(board, port);
    if (!array.tile(tile).powered) throw new TilencaError(`${port} has no power, and executes nothing; switch it on first`);
    const aheadS = array.timeS + LONGEST_STEP_S;
    if (count && (board.faults.nextS <= aheadS || this.#timeline.deedsIn(array.timeS, aheadS).length > 0)) {
      throw new TilencaError("a planned fault or deed is about to happen; let time go past it, by one update");
    }
    this.#stepper.step(tile, count);
    this.#timeline.reached(array.timeS);
    this.#look();
    this.#events.push(this.#stepper.tell(tile));
  }

  /** Lets a tile go on that was halted between two instructions, up to the present of the others. */
  #release() {
    if (this.#board && this.#stepper.release()) this.#passTime(this.#board, QUANTUM_S);
  }

  /** @param {Command} wanted */
  #open(wanted) {
    /** @type {{ timeS: number, deed: Command }[]} */
    const deeds = wanted.deeds
      .toSorted((/** @type {[number, Command]} */ [one], /** @type {[number, Command]} */ [other]) => one - other)
      .map((/** @type {[number, Command]} */ [timeS, deed]) =>
        ({ timeS: Math.floor(timeS / QUANTUM_S + 0.5) * QUANTUM_S, deed: checked(deed) }));
    /** @type {Place[]} */
    const cells = sorted(wanted.cells);
    const name = this.#nameOf(cells);
    const board = new Board(this.emulator, {
      image: this.image, name, cells, seed: wanted.seed, faults: wanted.faults, spreadS: wanted.spread_s,
      periodMs: this.offer.period_ms, updates: this.offer.updates,
    });
    this.close();
    this.#board = board;
    this.#teller = new Teller(board);
    this.#stepper = new Stepper(board.array);
    this.#timeline = new Timeline(deeds);
    this.#pace = new Pace(wanted.speed, wanted.paused, wanted.until_s);
    this.#events = [event(0, { run: { seed: wanted.seed, shape: name, tiles: cells.length } })];
    for (const { timeS, deed } of deeds) this.#tell(timeS, { deed });
    for (const planned of this.#timeline.deedsIn(-QUANTUM_S, 0)) this.#doPlanned(board, planned);
    this.#look();
    this.#keep(board);
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
    this.#stepper.release();
    const { array } = this.#board;
    const [startedS, beforeS] = [this.clock(), array.timeS];
    try {
      this.#passTime(this.#board, seconds);
    } catch (error) {
      this.#pace.paused = true;
      this.#look();
      throw error;
    }
    this.#pace.ran(array.timeS - beforeS, this.clock() - startedS, array.timeS);
    this.#look();
    if (this.#timeline.isDue(array.timeS)) this.#keep(this.#board);
  }

  /** Runs on; in a past that is known, hands do what they did. @param {Board} board @param {number} seconds */
  #passTime(board, seconds) {
    const { array, faults } = board;
    const endS = array.timeS + seconds;
    for (const planned of this.#timeline.deedsIn(array.timeS, endS)) {
      faults.run(Math.max(planned.timeS - array.timeS, 0));
      this.#doPlanned(board, planned);
    }
    if (endS > array.timeS) faults.run(endS - array.timeS);
    this.#timeline.reached(array.timeS);
  }

  /** @param {Board} board */
  #keep(board) {
    const moment = board.save();
    const said = this.#teller.save();
    this.#timeline.keep(moment.timeS, { board: moment, said }, moment.snapshot.length + VOICE_BYTES * said.length);
  }

  /**
   * Goes to a time that the run has been at; all that hands did until then is done.
   * @param {number} wantedS @param {boolean} forget what they did later is taken back
   */
  #seek(wantedS, forget) {
    const board = this.#board;
    if (!board) throw new TilencaError("nothing runs yet; open a drawing first");
    this.#release();
    const [fromS, timeS] = [board.array.timeS, Math.min(wantedS, this.#timeline.endS)];
    const nearest = this.#timeline.nearest(timeS);
    if (!(nearest.timeS <= fromS && fromS <= timeS)) { // or it is nearer to run on
      board.restore(nearest.moment.board);
      this.#teller.restore(nearest.moment.said);
    }
    this.#pace.set(this.#pace.speed, true);
    this.#passTime(board, timeS - board.array.timeS);
    if (forget) this.#timeline.endAt(board.array.timeS);
    this.#events = this.#events.filter((one) => "run" in one || "refused" in one);
    this.#tell(board.array.timeS, { jump: { from: Number(fromS.toFixed(6)), ...(forget && { forget }) } });
    this.#events.push(...this.#teller.all());
    this.#tellPace();
  }

  // --- what the page is told ---

  #look() {
    const { speed } = this.#pace;
    this.#events.push(...this.#teller.look(speed > 0 && speed <= FRAMES_SPEED));
    this.#tellPace();
  }

  #tellPace() {
    if (!this.#board) return;
    const { speed, paused, share } = this.#pace;
    this.#tell(this.#board.array.timeS, {
      pace: { speed, paused, share: Number(share.toFixed(3)), end: Number(this.#timeline.endS.toFixed(6)) },
    });
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
