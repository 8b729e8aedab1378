// The page: one source of events, one picture of the tiles, and the hands that reach in.

/** @import { Command, Drawing, Place, StreamEvent } from "./stream/source.js" */
import { Aside } from "./components/aside.js";
import { Agreement } from "./components/agreement.js";
import { Bar, toolName } from "./components/bar.js";
import { Board } from "./components/board.js";
import { lostWords } from "./components/connection.js";
import { bring, byId } from "./components/dom.js";
import { ask, isCompared, obeyParent, tellNow, tellParent } from "./components/framed.js";
import { Drawings } from "./components/drawings.js";
import { FleetPanel } from "./components/fleet.js";
import { Help } from "./components/help.js";
import { Hint } from "./components/hint.js";
import { Inspector } from "./components/inspector.js";
import { listenToKeys } from "./components/keys.js";
import { Left } from "./components/left.js";
import { LensPanel } from "./components/lens.js";
import { Lesson } from "./components/lesson.js";
import { Notice } from "./components/notice.js";
import { offerOnly, refusal } from "./components/offer.js";
import { Share } from "./components/share.js";
import { SharedRun } from "./components/shared.js";
import { Timeline } from "./components/timeline.js";
import { UsbPanel } from "./components/usb.js";
import { Verdict } from "./components/verdict.js";
import { readAddress } from "./stream/address.js";
import { deedMoments } from "./stream/deeds.js";
import { cellsOf } from "./stream/drawing.js";
import { openEmulator } from "./stream/emulator.js";
import { Recorder } from "./stream/recorder.js";
import { openOwnRecording, openRecording } from "./stream/recording.js";
import { Run } from "./stream/run.js";
import { openServer } from "./stream/socket.js";
import { surprise } from "./stream/surprise.js";
import { Tiles } from "./stream/tiles.js";

// A little before a deed: more than the emulator's quantum of time, and less than a tile needs for anything.
const MOMENT_S = 1e-4;

export const tiles = new Tiles();
const recorder = new Recorder();
const run = new Run(tiles, (command) => source.send(command));
let lastRefused = "";
let wasBuilding = false;
let jumps = 0;
/** The run that the page goes back to from a recording. @type {Aside | null} */
let aside = null;

/** @param {Command} command */
function send(command) {
  if (!tiles.can(command.do)) {
    notice.say(refusal(tiles));
    return;
  }
  left.note(command);
  run.note(command);
  hint.note(command.do);
  source.send(command);
}

/** What takes the last deed back, until it is sent; in a comparison it goes through the page around. @type {{seconds: number, goesOn: boolean, words: string} | null} */
let takenBack = null;

/** @param {number} seconds */
function seek(seconds) {
  const undone = takenBack?.seconds === seconds ? takenBack : null;
  takenBack = null;
  send({ do: "seek", seconds, ...(undone && { forget: true }) });
  if (undone?.goesOn) deeds.pace(tiles.pace.speed, false);
  if (undone) notice.say(`Taken back: ${undone.words}.`);
}

const deeds = {
  /** @param {string} text */
  say: (text) => notice.say(text),
  /** @param {string | null} port */
  select(port) {
    const chosen = port === board.selected ? null : port;
    board.select(chosen);
    inspector.show(chosen);
    hint.update();
    if (!chosen) return;
    bring(inspector.scores);
    board.bring(chosen, inspector.root);
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
  /** @param {import("./stream/groups.js").Shift} shift */
  shift(shift) {
    send({ do: "shift", ...shift });
    if (shift.ports.length === tiles.byPlace.size) notice.say("All tiles have moved together: that is the same shape, and the board stays around it.");
  },
  /** @param {string} port @param {string} side @param {boolean} on */
  cut: (port, side, on) => send({ do: "cut", port, side, on }),
  /** @param {string} port @param {boolean} on */
  power: (port, on) => send({ do: "power", port, on }),
  /** @param {string} port @param {boolean} on */
  freeze: (port, on) => send({ do: "freeze", port, on }),
  /** @param {string} port @param {boolean} on */
  turn: (port, on) => send({ do: "turn", port, on }),
  /** @param {string} port @param {number} ppm */
  skew: (port, ppm) => send({ do: "skew", port, ppm }),
  /** @param {string} port @param {number} count */
  instruct: (port, count) => send({ do: "instruct", port, count }),
  /** @param {string} port */
  reset: (port) => send({ do: "reset", port }),
  /** @param {string} port */
  press: (port) => send({ do: "restart", port }),
  /** @param {string} port */
  blink: (port) => send({ do: "blink", port }),
  /** @param {string} name @param {number} value @param {string | null} port null: all of them */
  set: (name, value, port) => send({ do: "set", name, value, port }),
  /** @param {import("./components/hands.js").Tool} tool */
  tool(tool) {
    board.choose(tool);
    hint.choose(tool);
  },
  /** @param {number} speed @param {boolean} paused */
  pace: (speed, paused) => send({ do: "pace", speed, paused }),
  /** One update; a run that goes on stands then. */
  step() {
    if (!tiles.pace.paused) deeds.pace(tiles.pace.speed, true);
    send({ do: "step", seconds: tiles.stepS });
  },
  /** Takes the last deed until now back: the tiles run on from there without it. */
  undo() {
    if (!tiles.can("arrange")) return notice.say(refusal(tiles));
    const last = deedMoments(tiles.deeds).findLast(({ time }) => time <= tiles.time + MOMENT_S);
    if (tiles.end === null) {
      notice.say("Time does not go back here: undo it by hand.");
    } else if (!last) {
      notice.say("There is nothing to take back.");
    } else {
      takenBack = { seconds: last.time - MOMENT_S, goesOn: !tiles.pace.paused, words: last.words };
      timeline.go(takenBack.seconds);
    }
  },
  /** One update back. */
  back: () => {
    if (tiles.end !== null) timeline.go(timeline.aim - tiles.stepS);
  },
  restart() {
    deeds.select(null);
    run.restart();
    bar.showNoise(run.noise);
  },
  /** @param {number} loss */
  noise(loss) {
    bar.showNoise(loss);
    send({ do: "noise", loss });
  },
  surprise() {
    for (const command of surprise(tiles, Math.random)) send(command);
  },
};

const notice = new Notice(byId("notice"));
const left = new Left(tiles, run, notice);
const hint = new Hint(byId("hint"), tiles, { isBusy: () => board.selected !== null, name: (port) => board.name(port) });
const board = new Board(byId("board"), tiles, deeds);
const inspector = new Inspector(byId("inspector"), tiles, deeds);
const bar = new Bar(byId("bar"), byId("top-deeds"), tiles, deeds);
const agreement = new Agreement(tiles, (seconds) => timeline.go(seconds));
const timeline = new Timeline(tiles, (seconds) => (isCompared ? ask({ seek: seconds }) : seek(seconds)));
const verdict = new Verdict();
new Share(byId("top-deeds"), tiles, recorder, {
  links() {
    const history = run.link();
    return { now: addressOf(run.linkNow()), history: history && addressOf(history) };
  },
  lens: () => board.lens,
  inChart: () => ({ from: agreement.view.begin, to: Math.min(agreement.view.begin + agreement.view.span, tiles.time) }),
  words: () => `${verdict.text}, ${tiles.time.toFixed(2)} s`,
  say: (text, stays) => (stays ? notice.stay(text) : notice.say(text)),
  compare: () => location.assign(`compare.html?${new URLSearchParams({ left: location.search, right: location.search })}${location.hash}`),
  canAlone: () => behind !== "recording",
  replay: (events, isCut) => usb.release(() => {
    if (!aside && tiles.end !== null && run.isOwn && run.hasBegun) aside = new Aside(source, ears, tiles, run, recorder);
    else source.close();
    const cut = isCut ? " Its last line was cut off; it ends before that." : "";
    notice.say(`A recording: go to any time of it.${cut}`);
    listenTo((listener) => openRecording(events, listener));
  }),
});
const lesson = new Lesson(byId("lesson"), byId("top-deeds"), tiles, {
  send,
  open(cells, speed) {
    left.leave();
    run.open({ ...readAddress("", tiles.drawings), cells, speed });
    bar.showNoise(run.noise);
  },
  selected: () => board.selected,
  close: () => board.selected && deeds.select(null),
  quiet: () => run.noise > 0 && deeds.noise(0),
  tool(tool) {
    if (board.hands.tool === tool) return "";
    bar.choose(tool);
    return toolName(tool);
  },
  choose: chooseModel,
});
const shared = new SharedRun(tiles, run, (command) => source.send(command));
const drawings = new Drawings(byId("drawings"), { slide: slideUnder, clear: drawOwn, model: chooseModel });
const fleet = new FleetPanel(byId("fleet"), tiles, deeds);
const lens = new LensPanel(byId("lens"), byId("scale"), tiles, (one) => board.look(one));
const usb = new UsbPanel(byId("usb"), byId("top-deeds"), tiles, {
  say: (text) => notice.say(text),
  choose(wanted) {
    deeds.select(null);
    source.close();
    leaveAside();
    listenTo(wanted ?? open);
  },
});
const help = new Help(byId("top-deeds"));
listenToKeys(bar, deeds, lens, () => board.selected && inspector.program.step(1), () => help.show());
obeyParent(deeds, seek, send);
// Only the board and time, for a lesson or an article; where two are compared, the board and its agreement.
if (new URLSearchParams(location.search).has("embed")) document.body.dataset.embed = isCompared ? "compare" : "";

/** Another drawing, with its middle where that of the tiles is. @param {Drawing} drawing */
function slideUnder(drawing) {
  const { view } = board;
  const row = view.top + Math.round((view.rows - drawing.rows.length) / 2);
  const col = view.left + Math.round((view.cols - drawing.rows[0].length) / 2);
  send({ do: "arrange", cells: cellsOf(drawing.rows).map(([r, c]) => [r + row, c + col]) });
  bring(board.root);
}

/** An empty board, and the tool to draw on it. */
function drawOwn() {
  deeds.select(null);
  const [first] = tiles.laid();
  if (first) {
    left.clear((seconds) => timeline.go(seconds));
    send({ do: "arrange", cells: [first.place] });
    send({ do: "pull", port: first.port });
  }
  bar.choose("pencil");
  bring(board.root);
}

/** Other tiles, with another model: on the same drawing and with its faults, where the model has it or it is an own one. @param {import("./stream/source.js").Model} model */
function chooseModel(model) {
  left.leave();
  const query = new URLSearchParams(run.linkNow());
  for (const name of ["until", "deed"]) query.delete(name);
  query.set("model", model.id || model.name);
  const step = new URLSearchParams(location.search).get("lesson");
  if (step) query.set("lesson", step);
  history.replaceState(null, "", `?${query}${location.hash}`);
  run.start = null;
  run.wantedModel = "";
  source.close();
  leaveAside();
  listenTo(open);
}

/** The whole address with a query, from `?` on. @param {string} query */
const addressOf = (query) => new URL(query + location.hash, location.href).href;

/** Notes what lies on the board now, in the address. */
function remember() {
  const before = run.otherModel();
  if (before && run.isOwn) notice.say(`The link is of model ${before}; these tiles run ${run.start?.model}, and may differ.`);
  drawings.mark(run.remember());
  tellNow(tiles);
}

/** @param {StreamEvent[]} events */
function show(events) {
  const now = performance.now();
  const isFirst = events.some((event) => event.stream !== undefined);
  tiles.take(events);
  recorder.take(events);
  if (isFirst) begin();
  if (tiles.jumps !== jumps) {
    jumps = tiles.jumps;
    bar.showNoise(run.noiseNow());
  }
  if (tiles.refused) {
    notice.say(tiles.refused);
    lastRefused = tiles.refused;
    tiles.refused = "";
    if (tiles.runs === 0) run.withoutRefused();
  }
  lesson.update();
  shared.update();
  lens.update();
  board.update(now);
  hint.update();
  inspector.update();
  bar.update();
  verdict.update(tiles, now);
  agreement.update(now);
  timeline.update(now);
  fleet.update(now);
  usb.update();
  tellNow(tiles);
}

/** A source is there: shows what it can do, and begins a run, unless its tiles run by themselves. */
function begin() {
  offerOnly(tiles);
  drawings.fill(tiles);
  if (tiles.source === "building") notice.stay(`The firmware of ${tiles.model} is built first; this takes about a minute, and the clock counts it.`);
  else if (tiles.source === "failed") tellFailed();
  else if (wasBuilding) notice.clear();
  wasBuilding = ["building", "failed"].includes(tiles.source);
  if (!tiles.can("open")) return;
  deeds.select(null);
  run.begin();
  bar.showNoise(run.noise);
  lesson.begin();
  tellParent(tiles, run.start?.cells ?? []);
}

/** The firmware was not built: says why, and another try or another model is the way on. */
function tellFailed() {
  const query = new URLSearchParams(location.search);
  query.delete("model"); // so that the page opens with tiles that run
  const text = query.toString();
  history.replaceState(null, "", `${location.pathname}${text && `?${text}`}${location.hash}`);
  const other = tiles.models.length > 1 ? "Choose another model, or reload the page" : "Reload the page";
  notice.stay(`The firmware of ${tiles.model} was not built: ${tiles.reason}. ${other}.`);
}

/** @returns {import("./components/aside.js").Ears} */
function newEars() {
  /** @type {import("./components/aside.js").Ears} */
  const made = {
    isOpen: true,
    isLost: false,
    onEvents: (events) => made.isOpen && show(events),
    onOpen() {
      if (!made.isOpen) return; // what lies aside and was lost is another run
      made.isLost = false;
      notice.settle();
    },
    onWhole: (events) => recorder.keep(events),
    onLost(seconds, code) {
      made.isLost = true;
      if (made.isOpen) notice.stay(lostWords(code, lastRefused, seconds));
    },
  };
  return made;
}

/** @param {(listener: import("./stream/source.js").Listener) => import("./stream/source.js").Source} opener of the source that the page shows from now on */
function listenTo(opener) {
  ears = newEars();
  source = opener(ears);
}

/** What lies aside is not gone back to. */
function leaveAside() {
  aside?.source.close();
  aside = null;
}

/** From a recording to what was there before. */
function leaveRecording() {
  if (!aside || aside.ears.isLost) return location.reload();
  deeds.select(null);
  source.close();
  ({ source, ears } = aside);
  aside.takeUp(tiles, run, recorder);
  aside = null;
  offerOnly(tiles);
  drawings.fill(tiles);
  notice.say(`Back to the run, which stands at ${tiles.time.toFixed(2)} s.`);
}

// The document says what stands behind it: `tilenca page`, the emulator beside it in the bundle, or a recording.
const behind = document.querySelector("meta[name=tilenca-source]")?.getAttribute("content") ?? "server";
const openers = { server: openServer, emulator: openEmulator, recording: openOwnRecording };
const open = openers[/** @type {keyof typeof openers} */ (behind)] ?? openServer;
let ears = newEars();
let source = open(ears);
usb.offer(behind);
byId("leave-recording").hidden = behind === "recording"; // nothing else is there
byId("leave-recording").addEventListener("click", leaveRecording);

setInterval(() => {
  remember();
  if (tiles.source === "building") verdict.update(tiles, performance.now());
}, 500);
document.addEventListener("visibilitychange", () => {
  if (tiles.can("rest")) source.send({ do: "rest", on: document.hidden });
});
