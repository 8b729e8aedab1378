// Batches of events from a source, shown once for every frame that the browser paints.

/** @import { Command, StreamEvent } from "./source.js" */

export class Batches {
  /** @type {StreamEvent[]} */
  #events = [];
  #last = 0;
  #isDue = false;

  /** @param {(events: StreamEvent[]) => void} show @param {(command: Command) => void} send to the source: what was seen */
  constructor(show, send) {
    this.show = show;
    this.send = send;
  }

  /** @param {{batch: number, events: StreamEvent[]}} told */
  take({ batch, events }) {
    for (const event of events) this.#events.push(event);
    this.#last = batch;
    if (this.#isDue) return;
    this.#isDue = true;
    requestAnimationFrame(() => this.paint());
  }

  /** Shows what has come. */
  paint() {
    if (!this.#isDue) return;
    this.#isDue = false;
    const events = this.#events;
    this.#events = [];
    this.show(events);
    this.send({ do: "seen", batch: this.#last });
  }
}
