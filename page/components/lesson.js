// The lesson beside the board: one step at a time, done when the tiles say so.

/** @import { Command, Model, Place } from "../stream/source.js" */
/** @import { Tiles } from "../stream/tiles.js" */
import { LABEL, STEPS, eight, isReady, preparation } from "../stream/lessons.js";
import { bring, element, icon, narrow, setText } from "./dom.js";

const ICON = "M12 4L2 9l10 5 10-5zM6 11.500V17c3 2.500 9 2.500 12 0v-5.500";
const SPEED = 0.3;
const DIGITS = "digits"; // the model for which it was written

/**
 * @typedef {{
 *   send: (command: Command) => void,
 *   open: (cells: Place[], speed: number) => void,
 *   selected: () => string | null,
 *   close: () => void,
 *   quiet: () => void,
 *   tool: (tool: import("./hands.js").Tool) => string,
 *   choose: (model: Model) => void,
 * }} LessonDeeds `tool` tells the name of one that was not chosen before; "": it was
 */

export class Lesson {
  /** @param {HTMLElement} root @param {HTMLElement} top @param {Tiles} tiles @param {LessonDeeds} deeds */
  constructor(root, top, tiles, deeds) {
    this.root = root;
    this.tiles = tiles;
    this.deeds = deeds;
    this.at = -1;
    this.isDone = false;
    /** Whether the step was there to do: nothing that was so before it began is its deed. */
    this.isOpen = false;
    /** What was looked into when the step began. @type {string | null} */
    this.before = null;
    this.since = { runs: 0, frames: 0, selected: /** @type {string | null} */ (null) };
    this.count = element("p", { class: "summary" });
    this.title = element("h3", { tabindex: -1, class: "step-title" });
    this.text = element("p");
    this.task = element("p", { class: "task" });
    this.tool = element("p", { class: "summary" });
    this.done = element("p", { class: "done", role: "status" });
    this.back = element("button", { type: "button", onclick: () => this.go(this.at - 1) }, "Back");
    this.next = element("button", { type: "button", onclick: () => this.go(this.at + 1) }, "Skip");
    this.use = element("button", { type: "button", class: "primary", hidden: true, onclick: () => {
      const model = this.model();
      if (model) this.deeds.choose(model);
    } });
    this.dots = STEPS.map(() => element("li"));
    root.append(
      element("header", {}, element("h2", { id: "lesson-title" }, "Lesson"), this.count,
        element("button", { type: "button", class: "round plain", "aria-label": "End the lesson", onclick: () => this.end() }, "×")),
      element("ol", { class: "steps", "aria-hidden": "true" }, ...this.dots),
      this.title, this.text, this.use, this.tool, this.task, this.done,
      element("div", { class: "deeds" }, this.back, this.next),
    );
    top.prepend(element(
      "button", { type: "button", class: "compact", title: "Eight short steps", "data-needs": "arrange", onclick: () => this.go(0) },
      icon(ICON), element("span", {}, "Lesson"),
    ));
  }

  /** Begins where the address says so; once for every source. */
  begin() {
    const wanted = new URLSearchParams(location.search).get("lesson");
    if (wanted === null || !this.tiles.can("arrange")) this.root.hidden = true;
    else this.go(this.at >= 0 ? this.at : Math.min(Math.max(Math.floor(Number(wanted)) || 1, 1), STEPS.length) - 1, true);
  }

  /** The model that knows the digits, of those that one can choose. */
  model() {
    const { models } = this.tiles;
    return models.find(({ name }) => name === DIGITS) ?? models.find(({ labels }) => labels.includes(LABEL));
  }

  /** @param {number} step @param {boolean} isNew whether the tiles are about to be others */
  go(step, isNew = false) {
    if (step >= STEPS.length) return this.end();
    const cells = eight(this.tiles);
    this.root.hidden = false;
    this.at = Math.max(0, step);
    const { title, text, task } = STEPS[this.at];
    setText(this.title, title);
    setText(this.text, cells.length ? text : "The lesson needs a model that knows the digits.");
    const model = cells.length ? undefined : this.model();
    this.use.hidden = !model;
    setText(this.use, model ? `Use ${model.name}` : "");
    setText(this.task, cells.length ? task : "");
    const tool = cells.length ? this.deeds.tool(STEPS[this.at].tool) : "";
    setText(this.tool, tool && `The tool is ${tool} now.`);
    this.deeds.close();
    setText(this.count, `${this.at + 1} of ${STEPS.length}`);
    this.dots.forEach((dot, index) => dot.classList.toggle("on", index <= this.at));
    this.back.disabled = this.at === 0;
    this.show(false);
    const commands = preparation(STEPS[this.at], this.tiles, isNew);
    this.before = this.deeds.selected();
    this.since = { runs: this.tiles.runs + (commands === null || isNew ? 1 : 0), frames: 0, selected: null };
    this.isOpen = isReady(STEPS[this.at], this.tiles, this.since) && !STEPS[this.at].isDone(this.tiles, this.since); // a hand may be quicker than the tiles
    if (cells.length) {
      this.deeds.quiet();
      if (commands === null) this.deeds.open(cells, SPEED);
      else for (const command of [...commands, ...this.hurry()]) this.deeds.send(command);
    }
    this.note(String(this.at + 1));
    this.title.focus({ preventScroll: true });
    return undefined;
  }

  /** After a step in slow motion, and from a pause, time goes on as fast as one likes to look. @returns {Command[]} */
  hurry() {
    const { speed, paused } = this.tiles.pace;
    return paused || (speed > 0 && speed < 0.1) ? [{ do: "pace", speed: Math.max(speed, SPEED), paused: false }] : [];
  }

  end() {
    this.at = -1;
    this.root.hidden = true;
    this.note(null);
  }

  /** Notes the step in the address. @param {string | null} step */
  note(step) {
    const query = new URLSearchParams(location.search);
    if (step === null) query.delete("lesson");
    else query.set("lesson", step);
    const text = query.toString().replaceAll("%2C", ",").replaceAll("%2F", "/").replaceAll("%40", "@").replaceAll("%3D", "=");
    history.replaceState(null, "", (text ? `?${text}` : location.pathname) + location.hash);
  }

  /** Looks whether the step is done; before the board forgets the frames. */
  update() {
    if (this.at < 0 || this.root.hidden) return;
    this.since.frames += this.tiles.pulses.length;
    const selected = this.deeds.selected();
    if (selected !== this.before) this.before = null;
    this.since.selected = this.before === null ? selected : null;
    if (this.isDone || (!this.isOpen && !isReady(STEPS[this.at], this.tiles, this.since))) return;
    const isDone = STEPS[this.at].isDone(this.tiles, this.since);
    if (isDone && this.isOpen) {
      this.show(true);
      bring(this.done, narrow.matches && selected ? "start" : "nearest"); // of the board below as much as there is room for
    }
    this.isOpen ||= !isDone;
  }

  /** @param {boolean} isDone */
  show(isDone) {
    this.isDone = isDone;
    const isLast = this.at === STEPS.length - 1;
    setText(this.done, isDone ? STEPS[this.at].done : "");
    this.task.classList.toggle("is-done", isDone);
    this.next.classList.toggle("primary", isDone);
    setText(this.next, isLast ? "End" : isDone ? "Next" : "Skip");
  }
}
