// Keeps the events of the run that is on the page, as a recording has them: in one line of time, without pauses.

/** @import { StreamEvent } from "./source.js" */

const MOST_EVENTS = 250_000;

export class Recorder {
  constructor() {
    /** @type {StreamEvent | null} */
    this.stream = null;
    /** The run and what followed. @type {StreamEvent[]} */
    this.events = [];
    /** Up to here all is kept. */
    this.known = 0;
    /** What is told of this time was told before. */
    this.jumpedTo = -1;
    /** Whether there was no room for more. */
    this.isFull = false;
    /** Whether it is a recording that is shown: all is kept from the beginning. */
    this.isWhole = false;
  }

  /** A recording is shown. @param {StreamEvent[]} recorded of `openRecording` */
  keep([stream, ...events]) {
    Object.assign(this, { stream, events, known: events.at(-1)?.time ?? 0, isFull: false, isWhole: true });
    this.events = this.events.filter((event) => !event.pace);
  }

  /** @param {StreamEvent[]} events */
  take(events) {
    if (this.isWhole) {
      const other = events.findIndex(({ stream, source }) => stream !== undefined && source !== "recording");
      if (other < 0) return;
      Object.assign(this, { events: [], known: 0, jumpedTo: -1, isFull: false, isWhole: false });
      events = events.slice(other);
    }
    for (const event of events) this.takeOne(event);
    if (this.events.length <= MOST_EVENTS) return;
    this.events = this.events.filter((event) => event.frame === undefined); // they are the most, and the least
    if (this.events.length > MOST_EVENTS / 2) this.isFull = true;
  }

  /** @param {StreamEvent} event */
  takeOne(event) {
    if (event.stream !== undefined) {
      this.stream = event;
    } else if (event.run) {
      Object.assign(this, { events: [event], known: 0, jumpedTo: -1, isFull: false });
    } else if (event.jump) {
      this.jumpedTo = event.time;
    } else if (event.pace) {
      const { end } = event.pace;
      if (end !== undefined && end < this.known) this.forget(end);
      this.known = Math.max(this.known, event.time);
    } else if (event.refused === undefined && !event.chip && !this.isFull && event.time >= this.known && event.time > this.jumpedTo) {
      this.events.push(event);
    }
  }

  /** Another future begins. @param {number} from */
  forget(from) {
    this.events = this.events.filter((event) => event.time <= from);
    this.known = from;
    this.jumpedTo = -1;
  }

  /** The recording: its events in order of time; the last one tells how long it is. @returns {StreamEvent[]} */
  recording() {
    const [run, ...rest] = this.events;
    if (!this.stream || !run) return [];
    const sorted = rest.filter(({ time }) => time <= this.known).sort((one, other) => one.time - other.time);
    const end = { time: this.known, pace: { speed: 1, paused: true, share: 1, end: this.known } };
    return [this.stream, run, ...sorted, end];
  }

  /** The same as a file: a line for each event. */
  text() {
    return this.recording().map((event) => `${JSON.stringify(event)}\n`).join("");
  }
}
