// The source that is a recording: its events again, at any speed, forwards and backwards. No hand changes it.

/** @import { Listener, Source, StreamEvent } from "./source.js" */
import { parseRecording } from "./recording_file.js";
import { subjectOf } from "./sentences.js";

const FULL_SPEED = 20; // where one asks for as fast as it can
const TAKES = ["open", "pace", "step", "seek", "rest"];

/** What an event is about, where the latest one counts; "" for those that pass. @param {StreamEvent} event @param {number} place */
function keyOf(event, place) {
  if (event.note !== undefined) return `note ${place}`;
  const kind = ["place", "open", "display", "cable", "fault", "health", "classes"].find((one) => one in event);
  if (kind) return `${kind} ${event.port} ${event.side ?? ""}`;
  if (event.raw === undefined) return "";
  return `raw ${event.port} ${subjectOf(event.raw)}`;
}

/**
 * The recording that lies in the document, or beside it.
 * @param {Listener} listener
 * @returns {Source}
 */
export function openOwnRecording(listener) {
  /** @type {Source | null} */
  let source = null;
  let isClosed = false;
  const inside = document.getElementById("recording");
  const token = new URLSearchParams(location.hash.slice(1)).get("token");
  /** @param {string} text */
  const begin = (text) => {
    if (!isClosed) source = openRecording(parseRecording(text).events, listener);
  };
  const read = async () => (inside ? inside.textContent ?? "" : (await fetch(`recording.jsonl${token ? `?token=${token}` : ""}`)).text());
  read().then(begin).catch((error) => {
    listener.onEvents([{ time: 0, refused: `The recording cannot be shown: ${error instanceof Error ? error.message : error}` }]);
  });
  return {
    send: (command) => source?.send(command),
    close: () => {
      isClosed = true;
      source?.close();
    },
  };
}

/**
 * @param {StreamEvent[]} recorded the events of `parseRecording`
 * @param {Listener} listener
 * @returns {Source}
 */
export function openRecording(recorded, listener) {
  const [first, run, ...rest] = recorded;
  const events = rest.filter((event) => !event.pace && !event.jump && !event.deed);
  const deeds = rest.filter((event) => event.deed); // told at the beginning, as those of a shared run are
  const end = Math.max(0, ...rest.slice(-1).map((event) => event.time), events.at(-1)?.time ?? 0);
  let [time, place, speed, paused, isResting] = [0, 0, 1, true, false];
  let reached = 0; // the page has been told all until then
  /** @type {StreamEvent[]} */
  let waiting = [{ ...first, source: "recording", of: first.of ?? first.source, takes: TAKES }];
  listener.onWhole?.(recorded);
  let before = performance.now();
  let frame = requestAnimationFrame(tick);

  /** @param {StreamEvent} event */
  const tell = (event) => waiting.push(event);
  const tellPace = () => tell({ time, pace: { speed, paused, share: 1, end } });

  /** @param {number} to */
  function pass(to) {
    time = Math.min(to, end);
    while (place < events.length && events[place].time <= time) tell(events[place++]);
    reached = Math.max(reached, time);
    if (time >= end) paused = true;
    tellPace();
  }

  /** Goes to a time; what the page does not know yet until then is told on the way. @param {number} wanted */
  function seek(wanted) {
    if (wanted > reached) {
      if (time < reached) jump(reached);
      pass(wanted);
    }
    jump(wanted);
  }

  /** Tells all that there is at a time. @param {number} wanted */
  function jump(wanted) {
    const from = time;
    /** @type {Map<string, StreamEvent>} */
    const last = new Map();
    for (place = 0; place < events.length && events[place].time <= wanted; place++) {
      const subject = keyOf(events[place], place);
      last.delete(subject); // so that it comes where the latest one does
      if (subject) last.set(subject, events[place]);
    }
    time = Math.min(wanted, end);
    paused = true;
    tell({ time, jump: { from } });
    for (const event of last.values()) tell(event);
    tellPace();
  }

  /** @param {number} now */
  function tick(now) {
    const passed = Math.min(Math.max(0, now - before) / 1000, 0.1);
    before = now;
    if (!paused && !isResting) pass(time + passed * (speed || FULL_SPEED));
    if (waiting.length) {
      const shown = waiting;
      waiting = [];
      listener.onEvents(shown);
    }
    frame = requestAnimationFrame(tick);
  }

  /** @type {Record<string, (command: any) => void>} */
  const obeyed = {
    open: (command) => {
      [time, place, reached, speed, paused] = [0, 0, 0, command.speed, false];
      tell(run);
      deeds.forEach(tell);
      pass(0);
    },
    pace: (command) => {
      ({ speed, paused } = command);
      tellPace();
    },
    step: ({ seconds }) => {
      if (paused) pass(time + seconds);
      paused = true;
    },
    seek: ({ seconds }) => seek(seconds),
    rest: ({ on }) => {
      isResting = on;
    },
  };
  return {
    send(command) {
      obeyed[command.do]?.(command);
    },
    close: () => cancelAnimationFrame(frame),
  };
}
