// What the tiles have shown over time: their changes of mind, and how many show what. After a jump into the past the
// future stays known, until a hand begins another one.

/**
 * A tile shows another label than before; "" for none.
 * @typedef {{time: number, port: string, from: string, to: string}} Change
 *
 * How many tiles show each label from a time on; dark ones under "".
 * @typedef {{time: number, counts: Map<string, number>, total: number}} Sample
 */

const MOST_KEPT = 4000;
const REST_S = 0.5; // without a change of mind: what was before is another matter
const AROUND_S = 0.1; // before and after changes that belong together

/** @param {Change} change */
const isOfMind = ({ from, to }) => from !== "" && to !== "";

export class History {
  constructor() {
    /** @type {Change[]} */
    this.changes = [];
    /** Changes of mind: from one label to another. */
    this.changeCount = 0;
    /** @type {Sample[]} */
    this.samples = [];
    /** Up to here all is known. */
    this.known = 0;
    /** Where the run has gone to last: what is told of then is no news. */
    this.jumpedTo = -1;
  }

  /** The changes of mind up to a time. @param {number} time */
  changesUntil(time) {
    let count = this.changeCount;
    for (let i = this.changes.length - 1; i >= 0 && this.changes[i].time > time; i--) if (isOfMind(this.changes[i])) count--;
    return count;
  }

  /** From when to when tiles changed their minds last, with a little around it; null: they did not. @param {number} time until then */
  lastBurst(time) {
    const times = this.changes.filter((change) => change.time <= time && isOfMind(change)).map((change) => change.time);
    let first = times.length - 1;
    if (first < 0) return null;
    const to = times[first];
    while (first > 0 && times[first] - times[first - 1] <= REST_S) first--;
    return { from: Math.max(0, times[first] - AROUND_S), to: Math.min(time, to + AROUND_S) };
  }

  /** What all tiles show at a time, and since when; null where they do not agree. @param {number} time */
  agreedAt(time) {
    /** @type {{since: number | null, label: string}} */
    const found = { since: null, label: "" };
    for (let index = this.samples.length - 1; index >= 0; index--) {
      const { time: from, counts, total } = this.samples[index];
      if (from > time) continue;
      const [label, count] = [...counts].find(([one]) => one) ?? ["", 0];
      if (!count || count !== total || (found.since !== null && label !== found.label)) break;
      Object.assign(found, { since: from, label });
    }
    return found;
  }

  /** Time has come to a moment; one can go to all those up to another. @param {number} time @param {number} [end] */
  pass(time, end) {
    if (end !== undefined && end < this.known) this.forget(end);
    this.known = Math.max(this.known, time);
  }

  /** Another future begins: what was known of this one is void. @param {number} from */
  forget(from) {
    this.changeCount -= this.changes.filter((change) => change.time > from && isOfMind(change)).length;
    this.changes = this.changes.filter((change) => change.time <= from);
    this.samples = this.samples.filter((sample) => sample.time <= from);
    this.known = from;
    this.jumpedTo = -1;
  }

  /** Whether something of this time is not known yet. @param {number} time */
  isNews(time) {
    return time > this.jumpedTo && time >= this.known;
  }

  /** @param {Change} change */
  note(change) {
    if (!this.isNews(change.time)) return;
    this.changes.push(change);
    if (isOfMind(change)) this.changeCount++;
    if (this.changes.length > MOST_KEPT) this.changes.splice(0, MOST_KEPT / 4);
  }

  /** Keeps a sample, if it is unlike the last one. @param {Sample} sample */
  sample(sample) {
    const { time, counts, total } = sample;
    if (!this.isNews(time)) return;
    const last = this.samples.at(-1);
    const isSame = last && last.total === total && last.counts.size === counts.size &&
      [...counts].every(([label, count]) => last.counts.get(label) === count);
    if (isSame) return;
    this.samples.push(sample);
    if (this.samples.length > MOST_KEPT) this.samples.splice(0, MOST_KEPT / 4);
  }
}
