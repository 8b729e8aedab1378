// Two runs side by side: two models, two drawings, two faults, or one seed and another. Each is the page in a frame.

/** @import { Here } from "./components/framed.js" */
import { SPEEDS, speedWords } from "./components/bar.js";
import { byId, element, setText } from "./components/dom.js";
import { DEFAULT_SPEED } from "./stream/address.js";
import { lossOf, withLoss } from "./stream/faults.js";

const NAMES = /** @type {const} */ (["left", "right"]);
const given = new URLSearchParams(location.search);
let [speed, paused] = [Number(new URLSearchParams(given.get("left") ?? "").get("speed") ?? DEFAULT_SPEED), false];

class Run {
  /** @param {"left" | "right"} name */
  constructor(name) {
    this.query = new URLSearchParams(given.get(name) ?? "");
    for (const one of ["until", "deed", "embed", "lesson"]) this.query.delete(one);
    this.frame = element("iframe", { title: `The ${name} run` });
    this.model = element("select", { onchange: () => this.change({ model: this.model.value, shape: null, draw: null }) });
    this.shape = element("select", { onchange: () => this.change({ shape: this.shape.value, draw: null }) });
    this.loss = element("input", { type: "number", min: 0, max: 100, step: 0.5, class: "number", onchange: () => this.changeLoss() });
    this.seed = element("input", { type: "number", title: "Another seed is other chance: when each tile is switched on, and which bytes get lost", min: 0, step: 1, class: "number", onchange: () => this.change({ seed: this.seed.value || "0" }) });
    /** @param {string} text @param {HTMLElement} control */
    const field = (text, control) => element("label", { title: control.title }, text, control);
    this.root = element("section", { class: "run", "aria-label": `The ${name} run` },
      element("form", { onsubmit: (/** @type {Event} */ event) => event.preventDefault() },
        field("Model", this.model), field("Drawing", this.shape), field("Lost bytes (%)", this.loss), field("Seed", this.seed)),
      element("span"), this.frame);
    this.load();
  }

  /** Begins it with what the fields say. */
  load() {
    this.query.set("speed", String(speed));
    this.seed.value = this.query.get("seed") ?? "0";
    this.loss.value = String(Math.round(lossOf(this.query.getAll("fault")) * 1000) / 10);
    this.frame.src = `./?embed&${this.query}${location.hash}`;
    note();
  }

  /** @param {Record<string, string | null>} fields null: none */
  change(fields) {
    for (const [name, value] of Object.entries(fields)) {
      if (value === null) this.query.delete(name);
      else this.query.set(name, value);
    }
    this.load();
  }

  changeLoss() {
    const share = Math.min(Math.max(Number(this.loss.value) || 0, 0), 100) / 100;
    const faults = withLoss(this.query.getAll("fault"), share);
    this.query.delete("fault");
    for (const fault of faults) this.query.append("fault", fault);
    this.load();
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
  }
}

/** @param {HTMLSelectElement} select @param {[string, string][]} options @param {string} chosen */
function fill(select, options, chosen) {
  select.replaceChildren(...options.map(([value, text]) => element("option", { value, selected: value === chosen }, text)));
}

/** @type {Run[]} */
const runs = [];

/** The address says what is compared. */
function note() {
  if (runs.length < NAMES.length) return;
  const address = new URLSearchParams(NAMES.map((name, index) => [name, runs[index].query.toString()]));
  history.replaceState(null, "", `?${address}${location.hash}`);
  const leave = /** @type {HTMLAnchorElement} */ (byId("leave"));
  leave.href = `./?${runs[0].query}${location.hash}`;
}

const play = element("button", { type: "button", onclick: () => pace(speed, !paused) }, "Pause");
const slider = element("input", {
  type: "range", min: 0, max: SPEEDS.length - 1, step: 1, "aria-label": "Speed of both",
  oninput: () => pace(SPEEDS[Number(slider.value)], paused),
});
const words = element("output");

/** @param {number} wanted @param {boolean} isPaused */
function pace(wanted, isPaused) {
  [speed, paused] = [wanted, isPaused];
  for (const run of runs) run.tell({ pace: { speed, paused } });
  show();
}

function show() {
  const nearest = SPEEDS.findIndex((one) => one >= speed && speed > 0);
  slider.value = String(nearest < 0 ? SPEEDS.length - 1 : nearest);
  slider.setAttribute("aria-valuetext", speedWords(speed));
  setText(words, speedWords(speed));
  setText(play, paused ? "Go on" : "Pause");
}

byId("both").append(
  play,
  element("button", { type: "button", class: "primary", onclick: () => {
    for (const run of runs) run.tell({ restart: true });
    pace(speed, false);
  } }, "Start both over"),
  element("label", { class: "slide" }, slider, words),
);
show();
for (const name of NAMES) runs.push(new Run(name));
byId("runs").append(...runs.map(({ root }) => root));
note();

addEventListener("message", ({ origin, source, data }) => {
  if (origin !== location.origin || !data?.tilenca?.here) return;
  runs.find(({ frame }) => frame.contentWindow === source)?.hear(data.tilenca.here);
});
