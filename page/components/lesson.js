// The lesson beside the board: one step at a time, done when the tiles say so.

/** @import { Command, Place } from "../stream/source.js" */
/** @import { Tiles } from "../stream/tiles.js" */
import { STEPS, eight, preparation } from "../stream/lessons.js";
import { element, icon, setText } from "./dom.js";

const ICON = "M12 4L2 9l10 5 10-5zM6 11.500V17c3 2.500 9 2.500 12 0v-5.500";
const SPEED = 0.3;

/**
 * @typedef {{
 *   send: (command: Command) => void,
 *   open: (cells: Place[], speed: number) => void,
 *   selected: () => string | null,
 * }} LessonDeeds
 */

export class Lesson {
  /** @param {HTMLElement} root @param {HTMLElement} top @param {Tiles} tiles @param {LessonDeeds} deeds */
  constructor(root, top, tiles, deeds) {
    this.root = root;
    this.tiles = tiles;
    this.deeds = deeds;
    this.at = -1;
    this.isDone = false;
    this.since = { runs: 0, frames: 0, selected: /** @type {string | null} */ (null) };
    this.count = element("p", { class: "summary" });
    this.title = element("h3", { tabindex: -1, class: "step-title" });
    this.text = element("p");
    this.task = element("p", { class: "task" });
    this.done = element("p", { class: "done", role: "status" });
    this.back = element("button", { type: "button", onclick: () => this.go(this.at - 1) }, "Back");
    this.next = element("button", { type: "button", onclick: () => this.go(this.at + 1) }, "Skip");
    this.dots = STEPS.map(() => element("li"));
    root.append(
      element("header", {}, element("h2", { id: "lesson-title" }, "Lesson"), this.count,
        element("button", { type: "button", class: "round plain", "aria-label": "End the lesson", onclick: () => this.end() }, "×")),
      element("ol", { class: "steps", "aria-hidden": "true" }, ...this.dots),
      this.title, this.text, this.task, this.done,
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
    else if (this.at < 0) this.go(Math.min(Math.max(Math.floor(Number(wanted)) || 1, 1), STEPS.length) - 1);
  }

  /** @param {number} step */
  go(step) {
    if (step >= STEPS.length) return this.end();
    const cells = eight(this.tiles);
    this.root.hidden = false;
    this.at = Math.max(0, step);
    const { title, text, task } = STEPS[this.at];
    setText(this.title, title);
    setText(this.text, cells.length ? text : "The lesson needs a model that knows the digits: choose it from the list below.");
    setText(this.task, cells.length ? task : "");
    setText(this.count, `${this.at + 1} of ${STEPS.length}`);
    this.dots.forEach((dot, index) => dot.classList.toggle("on", index <= this.at));
    this.back.disabled = this.at === 0;
    this.show(false);
    if (cells.length) {
      const commands = preparation(STEPS[this.at], this.tiles);
      if (commands === null) this.deeds.open(cells, SPEED);
      else for (const command of [...commands, ...this.hurry()]) this.deeds.send(command);
    }
    this.since = { runs: this.tiles.runs + (preparation(STEPS[this.at], this.tiles) === null ? 1 : 0), frames: 0, selected: null };
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
    this.since.selected = this.deeds.selected();
    if (!this.isDone && STEPS[this.at].isDone(this.tiles, this.since)) this.show(true);
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
