// The page: one source of events, one picture of the tiles, and the hands that reach in.

/** @import { Command, Drawing, Place, StreamEvent } from "./stream/source.js" */
/** @import { Start } from "./stream/address.js" */
import { Agreement } from "./components/agreement.js";
import { Bar } from "./components/bar.js";
import { Board } from "./components/board.js";
import { byId } from "./components/dom.js";
import { Drawings } from "./components/drawings.js";
import { Inspector } from "./components/inspector.js";
import { listenToKeys } from "./components/keys.js";
import { Notice } from "./components/notice.js";
import { Share } from "./components/share.js";
import { Timeline } from "./components/timeline.js";
import { Verdict } from "./components/verdict.js";
import { cellsOf, known, readAddress, writeAddress } from "./stream/address.js";
import { openEmulator } from "./stream/emulator.js";
import { MOST_DEEDS, MOST_TEXT } from "./stream/deeds.js";
import { faultsNow, kindsChangedBy } from "./stream/faults.js";
import { Recorder } from "./stream/recorder.js";
import { openRecording } from "./stream/recording.js";
import { openServer } from "./stream/socket.js";
import { BROKE_OFF, TOO_MANY_PAGES, WRONG_TOKEN } from "./stream/source.js";
import { surprise } from "./stream/surprise.js";
import { Tiles } from "./stream/tiles.js";

export const tiles = new Tiles();
const recorder = new Recorder();
/** @type {Start | null} */
let start = null;
let noise = 0;
let lastRefused = "";

/** What the run was given at its start, and the kinds of it that a hand has changed since. @type {string[]} */
let given = [];
/** @type {Set<string>} */
const handled = new Set();
/** What the run began with. @type {Start | null} */
let opened = null;

/** @param {Command} command */
function send(command) {
  for (const kind of kindsChangedBy(command)) handled.add(kind);
  source.send(command);
}

const deeds = {
  /** @param {string | null} port */
  select(port) {
    const chosen = port === board.selected ? null : port;
    board.select(chosen);
    inspector.show(chosen);
  },
  /** @param {Place} place */
  put: ([row, col]) => send({ do: "put", row, col }),
  /** @param {string} port */
  pull(port) {
    if (port === board.selected) deeds.select(null);
    send({ do: "pull", port });
  },
  /** @param {string} port @param {Place} place */
  move: (port, [row, col]) => send({ do: "move", port, row, col }),
  /** @param {string} port @param {string} side @param {boolean} on */
  cut: (port, side, on) => send({ do: "cut", port, side, on }),
  /** @param {string} port @param {boolean} on */
  power: (port, on) => send({ do: "power", port, on }),
  /** @param {string} port @param {boolean} on */
  freeze: (port, on) => send({ do: "freeze", port, on }),
  /** @param {string} port */
  reset: (port) => send({ do: "reset", port }),
  /** @param {import("./components/hands.js").Tool} tool */
  tool(tool) {
    board.hands.tool = tool;
    byId("board").dataset.tool = tool;
  },
  /** @param {number} speed @param {boolean} paused */
  pace(speed, paused) {
    if (start) start.speed = speed;
    send({ do: "pace", speed, paused });
  },
  step: () => send({ do: "step", seconds: tiles.stepS }),
  /** One update back. */
  back: () => {
    if (tiles.end !== null) timeline.go(timeline.aim - tiles.stepS);
  },
  restart() {
    if (!start) return;
    remember();
    start.until = null;
    start.deeds = [];
    open(start);
  },
  /** @param {number} loss */
  noise(loss) {
    noise = loss;
    bar.showNoise(loss);
    send({ do: "noise", loss });
  },
  surprise() {
    for (const command of surprise(tiles, Math.random)) send(command);
  },
};

const notice = new Notice(byId("notice"));
const board = new Board(byId("board"), tiles, deeds);
const inspector = new Inspector(byId("inspector"), tiles, deeds);
const bar = new Bar(byId("bar"), byId("top-deeds"), tiles, deeds);
const agreement = new Agreement(tiles);
const timeline = new Timeline(tiles, (seconds) => send({ do: "seek", seconds }));
const verdict = new Verdict();
new Share(byId("top-deeds"), tiles, recorder, {
  link: linkUntilNow,
  words: () => `${verdict.text}, ${tiles.time.toFixed(2)} s`,
  say: (text) => notice.say(text),
  replay(events) {
    source.close();
    notice.say("A recording: go to any time of it. Reload the page for running tiles.");
    source = openRecording(events, listener);
  },
});
const drawings = new Drawings(byId("drawings"), (drawing) => slideUnder(drawing));
listenToKeys(bar, deeds);

/** Another drawing, with its middle where that of the tiles is. @param {Drawing} drawing */
function slideUnder(drawing) {
  const { view } = board;
  const row = view.top + Math.round((view.rows - drawing.rows.length) / 2);
  const col = view.left + Math.round((view.cols - drawing.rows[0].length) / 2);
  send({ do: "arrange", cells: cellsOf(drawing.rows).map(([r, c]) => [r + row, c + col]) });
}

/** Begins a run. @param {Start} wanted */
function open(wanted) {
  deeds.select(null);
  given = wanted.faults;
  opened = { ...wanted };
  handled.clear();
  for (const { deed } of wanted.deeds) for (const kind of kindsChangedBy(deed)) handled.add(kind);
  noise = Number(wanted.faults.map((fault) => /^loss=([\d.]+)$/.exec(fault)?.[1]).find(Boolean) ?? 0);
  bar.showNoise(noise);
  const { cells, seed, speed, faults, spread, until } = wanted;
  const planned = wanted.deeds.map(({ time, deed }) => [time, deed]);
  send({ do: "open", cells, seed, speed, faults, spread_s: spread, until_s: until, deeds: planned });
}

/** The address of the run as it was, with all that hands did, until now. */
function linkUntilNow() {
  if (!opened || tiles.source === "recording" || tiles.deeds.length > MOST_DEEDS) return location.href;
  const until = Number(tiles.time.toFixed(6));
  const deeds = tiles.deeds.filter(({ time }) => time <= until);
  const run = { ...opened, speed: start?.speed ?? opened.speed, model: start?.model ?? "", until, deeds };
  if (JSON.stringify(run).length > MOST_TEXT) {
    notice.say("Too much was done for a link: it is that of the board as it lies now. Save a recording instead.");
    return location.href;
  }
  return new URL(writeAddress(run, tiles.drawings) + location.hash, location.href).href;
}

/** Notes what lies on the board now, in `start` and in the address. */
function remember() {
  if (tiles.source === "recording") return;
  checkModel();
  const laid = tiles.laid();
  if (!start || !laid.length) return;
  start.cells = laid.map((tile) => tile.place);
  const isUp = tiles.time > start.spread + 0.1;
  if (isUp) start.faults = faultsNow(tiles, given, handled, noise);
  const address = writeAddress({ ...start, deeds: [] }, tiles.drawings);
  if (address !== location.search) history.replaceState(null, "", address + location.hash);
  drawings.mark(known(start.cells, tiles.drawings)?.name ?? "");
}

/** @param {StreamEvent[]} events */
function show(events) {
  const now = performance.now();
  const first = events.find((event) => event.stream !== undefined);
  tiles.take(events);
  recorder.take(events);
  if (first) {
    drawings.fill(tiles.drawings, (label) => tiles.look(label).rgb);
    start = start ?? readAddress(location.search, tiles.drawings);
    open(start);
  }
  if (tiles.refused) {
    notice.say(tiles.refused);
    lastRefused = tiles.refused;
    tiles.refused = "";
    if (tiles.runs === 0 && start?.faults.length) open((start = { ...start, faults: [] }));
  }
  board.update(now);
  inspector.update();
  bar.update();
  verdict.update(tiles, now);
  agreement.update(now);
  timeline.update(now);
}

/** Says so where the address was made with another model. */
function checkModel() {
  const modelId = tiles.laid().find((tile) => tile.modelId)?.modelId;
  if (!start || !modelId || start.model === modelId) return;
  if (start.model) notice.say(`The link is of model ${start.model}; these tiles run ${modelId}, and may differ.`);
  start.model = modelId;
}

/** @type {import("./stream/source.js").Listener} */
const listener = {
  onEvents: show,
  onOpen: () => notice.clear(),
  onLost: (seconds, code) => notice.stay(lostWords(code, `trying again in ${Math.ceil(seconds)} s`)),
};
// The document says what stands behind it: `tilenca page`, or the emulator beside it in the bundle.
const behind = document.querySelector("meta[name=tilenca-source]")?.getAttribute("content");
let source = behind === "emulator" ? openEmulator(listener) : openServer(listener);

/** @param {number} code of the end of the connection @param {string} again when it is tried again */
function lostWords(code, again) {
  switch (code) {
    case WRONG_TOKEN:
      return "The address has not the right token: open the one that tilenca page has printed.";
    case BROKE_OFF:
      return `${lastRefused || "The run broke off"}; reload the page to begin again.`;
    case TOO_MANY_PAGES:
      return `${lastRefused || "Too many pages are open already; close one of them"}; ${again}`;
    default:
      return `The tiles are out of reach; ${again}`;
  }
}

setInterval(remember, 500);
document.addEventListener("visibilitychange", () => send({ do: "rest", on: document.hidden }));
