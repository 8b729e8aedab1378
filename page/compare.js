// Two runs side by side on one clock: two models, two drawings, two faults, or one seed and another. Each is the page in a frame.

/** @import { Here, Now, Wish } from "./components/framed.js" */
import { SPEEDS, speedWords } from "./components/bar.js";
import { byId, element, setText } from "./components/dom.js";
import { deliberate } from "./components/slider.js";
import { Timeline } from "./components/timeline.js";
import { DEFAULT_SPEED } from "./stream/address.js";
import { differenceWords, resultWords } from "./stream/comparison.js";
import { lossOf, withLoss } from "./stream/faults.js";

const NAMES = /** @type {const} */ (["left", "right"]);
// What of an address is no part of a run that is compared.
const LEFT_OUT = ["until", "deed", "embed", "lesson"];
const OWN = "your own";
// A run waits for the other one, if it is ahead by so much of the watcher's time, in seconds.
const SLACK_S = 0.1;
const given = new URLSearchParams(location.search);
let [speed, paused] = [Number(new URLSearchParams(given.get("left") ?? "").get("speed") ?? DEFAULT_SPEED), false];
// Whether both stand at the same time, once they have been paused.
let isLevel = false;

class Run {
  /** @param {"left" | "right"} name */
  constructor(name) {
    this.query = queryOf(given.get(name) ?? "");
    /** How far it is; null until it has begun. @type {Now | null} */
    this.now = null;
    this.isThere = false;
    /** Whether it waits for the other one. */
    this.isHeld = false;
    this.frame = element("iframe", { title: `The ${name} run` });
    this.model = element("select", { onchange: () => this.change({ model: this.model.value, shape: null, draw: null }) });
    this.shape = element("select", { onchange: () => this.change({ shape: this.shape.value, draw: null }) });
    this.loss = element("input", { type: "number", min: 0, max: 100, step: 0.5, class: "number", onchange: () => this.changeLoss() });
    this.seed = element("input", { type: "number", title: "Another seed is other chance: when each tile is switched on, and which bytes get lost", min: 0, step: 1, class: "number", onchange: () => this.change({ seed: this.seed.value || "0" }) });
    /** @param {string} text @param {HTMLElement} control */
    const field = (text, control) => element("label", { title: control.title }, text, control);
    const title = name[0].toUpperCase() + name.slice(1);
    this.root = element("section", { class: "run", "aria-label": `The ${name} run` },
      element("details", { ontoggle: (/** @type {Event} */ event) => foldAll(event), open: !matchMedia("(max-width: 760px), (max-height: 560px)").matches },
        element("summary", {}, element("h2", {}, title), element("span", { class: "summary" }, "Settings")),
        element("form", { onsubmit: (/** @type {Event} */ event) => event.preventDefault() },
          field("Model", this.model), field("Drawing", this.shape), field("Lost bytes (%)", this.loss), field("Seed", this.seed))),
      this.frame);
  }

  /** Begins it with what the fields say. */
  load() {
    this.query.set("speed", String(speed));
    [this.now, this.isThere, this.isHeld] = [null, false, false];
    this.frame.src = `./?embed=compare&${this.query}${location.hash}`;
    this.showFields();
  }

  showFields() {
    this.seed.value = this.query.get("seed") ?? "0";
    this.loss.value = String(this.lossPercent);
    const drawing = this.query.get("draw") ? OWN : this.query.get("shape");
    if (drawing === OWN && ![...this.shape.options].some(({ value }) => value === OWN)) this.shape.append(element("option", { value: OWN, disabled: true }, OWN));
    if (drawing) this.shape.value = drawing;
  }

  get lossPercent() {
    return Math.round(lossOf(this.query.getAll("fault")) * 1000) / 10;
  }

  /** @param {Record<string, string | null>} fields null: none */
  change(fields) {
    for (const [name, value] of Object.entries(fields)) {
      if (value === null) this.query.delete(name);
      else this.query.set(name, value);
    }
    startOver(this);
  }

  changeLoss() {
    const share = Math.min(Math.max(Number(this.loss.value) || 0, 0), 100) / 100;
    const faults = withLoss(this.query.getAll("fault"), share);
    this.query.delete("fault");
    for (const fault of faults) this.query.append("fault", fault);
    startOver(this);
  }

  /** @param {object} message to the page in the frame */
  tell(message) {
    this.frame.contentWindow?.postMessage({ tilenca: message }, location.origin);
  }

  /** What the page in the frame offers. @param {Here} here */
  hear({ models, model, drawings, drawing }) {
    const named = models.length ? models : [{ name: model || "digits", id: "" }];
    fill(this.model, named.map(({ name, id }) => [id || name, name]), named.find(({ name }) => name === model)?.id ?? "");
    fill(this.shape, drawings.map((name) => [name, name]), drawing);
    this.model.disabled = models.length < 2;
    this.isThere = true;
    this.showFields();
  }

  /** How far it is, and what hands have changed. @param {Now} now */
  follow(now) {
    if (!this.isThere) return; // of the run before
    this.now = now;
    const query = queryOf(now.query);
    if (query.toString() === this.query.toString()) return;
    this.query = query;
    if (!document.activeElement?.closest("form")) this.showFields();
    note();
  }

  /** @returns {import("./stream/comparison.js").Settings} */
  get settings() {
    const others = this.now?.faults.join("; ") ?? "";
    const drawing = this.query.get("draw") ?? this.query.get("shape") ?? "";
    const { lossPercent } = this;
    return [
      ["model", this.model.value, this.model.selectedOptions[0]?.text ?? ""],
      ["drawing", drawing || this.shape.value, this.query.get("draw") ? OWN : this.shape.value],
      ["lost bytes", String(lossPercent), lossPercent ? `${lossPercent}\u00a0%` : "none"],
      ["seed", this.seed.value, this.seed.value],
      ["time within which tiles are switched on", this.query.get("spread") ?? "", this.query.get("spread") ? `${this.query.get("spread")} s` : "as usual"],
      ["other faults", others, others || "none"],
    ];
  }
}

/** Folds the settings of both alike, so that both boards have one size. @param {Event} event */
function foldAll({ currentTarget }) {
  const { open } = /** @type {HTMLDetailsElement} */ (currentTarget);
  for (const run of runs) for (const one of run.root.getElementsByTagName("details")) one.open = open;
}

/** What an address says of a run. @param {string} text */
function queryOf(text) {
  const query = new URLSearchParams(text);
  for (const one of LEFT_OUT) query.delete(one);
  return query;
}

/** @param {HTMLSelectElement} select @param {[string, string][]} options @param {string} chosen */
function fill(select, options, chosen) {
  select.replaceChildren(...options.map(([value, text]) => element("option", { value, selected: value === chosen }, text)));
}

/** The address says what is compared. */
function note() {
  const address = new URLSearchParams(NAMES.map((name, index) => [name, runs[index].query.toString()]));
  history.replaceState(null, "", `?${address}${location.hash}`);
  const leave = /** @type {HTMLAnchorElement} */ (byId("leave"));
  leave.href = `./?${runs[0].query}${location.hash}`;
}

/** Both from their beginning, since they have one clock. @param {Run} [changed] the one that is another run now */
function startOver(changed) {
  [paused, isLevel] = [false, false];
  for (const run of runs) {
    if (run === changed) run.load();
    else if (run.isThere) run.tell({ restart: true, pace: { speed, paused } });
    run.isHeld = false;
  }
  note();
  show();
}

/** @param {number} wanted @param {boolean} isPaused */
function pace(wanted, isPaused) {
  [speed, paused, isLevel] = [wanted, isPaused, false];
  for (const run of runs) {
    run.tell({ pace: { speed, paused } });
    run.isHeld = false;
  }
  show();
}

/** @param {number} seconds */
function seek(seconds) {
  [paused, isLevel] = [true, true];
  for (const run of runs) run.tell({ seek: seconds });
  show();
}

/** One update of both; runs that go on stand first. */
function step() {
  if (!paused) pace(speed, true);
  else for (const run of runs) run.tell({ step: both.stepS });
}

/** Lets the one that is ahead wait, and, once both stand, go back to where the other one is. */
function keepTogether() {
  const [left, right] = runs.map(({ now }) => now);
  const lead = (left?.time ?? 0) - (right?.time ?? 0);
  if (!paused) {
    runs.forEach((run, index) => {
      const ahead = index ? -lead : lead;
      const isHeld = run.now !== null && ahead > (run.isHeld ? 0 : SLACK_S * (speed || 1));
      if (isHeld !== run.isHeld) run.tell({ pace: { speed, paused: isHeld } });
      run.isHeld = isHeld;
    });
  } else if (!isLevel && left?.paused && right?.paused) {
    if (lead) seek(Math.min(left.time, right.time));
    isLevel = true;
  }
}

/** Both as one, for the line of time. */
const both = {
  get time() {
    return Math.min(...runs.map(({ now }) => now?.time ?? 0));
  },
  get end() {
    const ends = runs.map(({ now }) => now?.end ?? null);
    return ends.includes(null) ? null : Math.min(...ends.map(Number));
  },
  get jumps() {
    return runs.reduce((sum, { now }) => sum + (now?.jumps ?? 0), 0);
  },
  get stepS() {
    return Math.max(...runs.map(({ now }) => now?.stepS ?? 0)) || 0.02;
  },
};

const play = element("button", { type: "button", onclick: () => pace(speed, !paused) }, "Pause");
const slider = element("input", {
  type: "range", min: 0, max: SPEEDS.length - 1, step: 1, "aria-label": "Speed of both",
  oninput: () => pace(SPEEDS[Number(slider.value)], paused),
});
deliberate(slider);
const words = element("output");

/** Shows what is asked of both. */
function show() {
  const nearest = SPEEDS.findIndex((one) => one >= speed && speed > 0);
  slider.value = String(nearest < 0 ? SPEEDS.length - 1 : nearest);
  slider.setAttribute("aria-valuetext", speedWords(speed));
  setText(words, speedWords(speed));
  setText(play, paused ? "Go on" : "Pause");
}

/** Shows how far both are. */
function update() {
  keepTogether();
  timeline.update(performance.now());
  const [left, right] = runs;
  if (left.isThere && right.isThere) setText(byId("difference"), differenceWords(left.settings, right.settings));
  setText(byId("result"), left.now && right.now ? resultWords(left.now, right.now) : `Waiting for the ${left.now ? "right" : "left"} run`);
}

/** @param {Wish} wish of a hand in one of the frames */
function obey(wish) {
  if (wish.restart) startOver();
  if (wish.pace) pace(Number(wish.pace.speed), Boolean(wish.pace.paused));
  if (wish.step) step();
  if (wish.seek !== undefined) seek(wish.seek);
}

const runs = NAMES.map((name) => new Run(name));
const timeline = new Timeline(both, seek);
byId("both").prepend(
  element("div", { class: "group" }, play,
    element("button", { type: "button", title: "One update of both, then stand", onclick: step }, "One update"),
    element("button", { type: "button", class: "primary", title: "Both from time 0, with what lies on their boards now", onclick: () => startOver() }, "Start both over")),
  element("label", { class: "slide" }, element("span", {}, "Speed"), slider, words),
);
for (const run of runs) run.load();
byId("runs").append(...runs.map(({ root }) => root));
note();
show();

/** The keys of time, as on the page of one run. @type {Record<string, () => void>} */
const KEYS = {
  p: () => pace(speed, !paused),
  r: () => startOver(),
  ".": step,
  ",": () => timeline.go(timeline.aim - both.stepS),
};
addEventListener("keydown", (event) => {
  const act = KEYS[event.key];
  if (!act || event.ctrlKey || event.altKey || event.metaKey || /** @type {HTMLElement} */ (event.target).closest("select, [type=number]")) return;
  act();
  event.preventDefault();
});

addEventListener("message", ({ origin, source, data }) => {
  if (origin !== location.origin || typeof data?.tilenca !== "object" || !data.tilenca) return;
  const run = runs.find(({ frame }) => frame.contentWindow === source);
  const { here, now, wish } = data.tilenca;
  if (!run) return;
  if (here) run.hear(here);
  if (now) run.follow(now);
  if (wish) obey(wish);
  update();
});
