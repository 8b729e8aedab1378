// Tools and time: what the pointer does, and how fast the tiles run.

/** @import { Tiles } from "../stream/tiles.js" */
/** @import { Tool } from "./hands.js" */
import { element, icon, setText } from "./dom.js";
import { deliberate } from "./slider.js";

/** Speeds to choose from, times real time; 0: as fast as it can. */
export const SPEEDS = [0.001, 0.01, 0.03, 0.1, 0.3, 1, 0];

// Percent; a frame has thirty bytes and is lost with one of them, so that more is hardly different from a cut
// cable. The slider reaches further only where a link says more.
const MOST_LOSS = 10;

export const PENCIL = "M4 20l1-5L16 4l4 4L9 19l-5 1M14 6l4 4";
const ICONS = {
  hand: "M8 13V5.5a1.5 1.5 0 0 1 3 0V12m0-1V4a1.5 1.5 0 0 1 3 0v8m0-6.500a1.500 1.500 0 0 1 3 0V15a6 6 0 0 1-6 6 6 6 0 0 1-5-3l-3-5a1.500 1.500 0 0 1 2.500-1.600L8 14",
  group: "M4 4h7v7H4zM13 4h7v7h-7zM4 13h7v7H4zM17 14v6M14 17h6",
  pencil: PENCIL,
  knife: "M3 21l7-7M9 12L19 3c2 4 1 9-5 14z",
  play: "M8 5v14l11-7z",
  pause: "M8 5v14M16 5v14",
  step: "M6 5v14l9-7zM18 5v14",
  again: "M5 12a7 7 0 1 1 2 5M5 19v-5h5",
  dice: "M5 5h14v14H5zM9 9h0M15 15h0M15 9h0M9 15h0",
};

/** @type {[Tool, string, string][]} */
const TOOLS = [
  ["hand", "Hand", "Move tiles, and click one to look into it (H)"],
  ["group", "Group", "Move all that hangs together; across empty places, break it apart (G)"],
  ["pencil", "Draw", "Put tiles in, and rub them out (D)"],
  ["knife", "Knife", "Cut cables, click to mend one (K)"],
];

/** @param {Tool} tool */
export const toolName = (tool) => TOOLS.find(([one]) => one === tool)?.[1] ?? "";

/** @param {number} speed */
export function speedWords(speed) {
  if (speed === 0) return "full speed";
  if (speed === 1) return "real time";
  return speed < 1 ? `${Math.round(1 / speed)} times slower` : `${speed} times faster`;
}

/** The same, as short as the bar needs it. @param {number} speed */
const speedText = (speed) => speedWords(speed).replace(" times ", "× ");

/**
 * @typedef {{
 *   tool: (tool: Tool) => void,
 *   pace: (speed: number, paused: boolean) => void,
 *   step: () => void,
 *   back: () => void,
 *   restart: () => void,
 *   surprise: () => void,
 *   noise: (loss: number) => void,
 * }} BarDeeds
 */

export class Bar {
  /** @param {HTMLElement} root @param {HTMLElement} top @param {Tiles} tiles @param {BarDeeds} deeds */
  constructor(root, top, tiles, deeds) {
    this.tiles = tiles;
    this.deeds = deeds;
    /** @type {Map<Tool, HTMLButtonElement>} */
    this.tools = new Map();
    const tools = element("div", { class: "group tools", role: "group", "aria-label": "Tool", "data-needs": "put" });
    for (const [tool, name, title] of TOOLS) {
      const button = element(
        "button", { type: "button", title, "aria-pressed": "false", onclick: () => this.choose(tool) },
        icon(ICONS[tool]), element("span", {}, name),
      );
      this.tools.set(tool, button);
      tools.append(button);
    }
    this.playIcon = icon(ICONS.pause);
    this.play = element(
      "button", { type: "button", class: "round", title: "Pause or go on (P, or Space unless the keyboard is on a button)", "aria-label": "Pause", onclick: () => this.toggle() },
      this.playIcon,
    );
    this.stepButton = element(
      "button", { type: "button", class: "round", title: "One update, then stand (.)", "aria-label": "One update", onclick: () => deeds.step() },
      icon(ICONS.step),
    );
    this.slider = element("input", {
      type: "range", min: 0, max: SPEEDS.length - 1, step: 1, id: "speed", "aria-label": "Speed",
      oninput: () => deeds.pace(SPEEDS[Number(this.slider.value)], this.tiles.pace.paused),
    });
    this.speed = element("output", { for: "speed", class: "speed-words" });
    this.noise = element("input", {
      type: "range", min: 0, max: MOST_LOSS, step: 0.5, value: 0, id: "noise", "aria-label": "Lost bytes", title: "The share of bytes that get lost on all cables",
      oninput: () => deeds.noise(Number(this.noise.value) / 100),
    });
    this.noiseWords = element("output", { for: "noise", class: "speed-words" });
    for (const slider of [this.slider, this.noise]) deliberate(slider);
    root.append(
      tools,
      element("div", { class: "group time", role: "group", "aria-label": "Time", "data-needs": "pace" }, this.play, this.stepButton,
        element("label", { class: "slide" }, element("span", { class: "caption" }, "Speed"), this.slider, this.speed)),
      element("div", { class: "group", role: "group", "aria-label": "Faults", "data-needs": "noise" },
        element("label", { class: "slide" }, element("span", { class: "caption" }, "Lost bytes"), this.noise, this.noiseWords)),
    );
    top.append(
      element("button", { type: "button", class: "compact", title: "Switch all tiles off and on (R)", "data-needs": "open", onclick: () => deeds.restart() },
        icon(ICONS.again), element("span", {}, "Start over")),
      element("button", { type: "button", class: "primary", title: "Something else happens (S)", "data-needs": "arrange", onclick: () => deeds.surprise() },
        icon(ICONS.dice), element("span", {}, "Surprise me")),
    );
    this.choose("hand");
    this.showNoise(0);
  }

  /** @param {Tool} tool */
  choose(tool) {
    for (const [name, button] of this.tools) button.setAttribute("aria-pressed", String(name === tool));
    this.deeds.tool(tool);
  }

  toggle() {
    this.deeds.pace(this.tiles.pace.speed, !this.tiles.pace.paused);
  }

  /** @param {number} loss */
  showNoise(loss) {
    const percent = Math.round(loss * 1000) / 10;
    this.noise.max = String(Math.max(Number(this.noise.max), percent));
    this.noise.value = String(percent);
    const words = loss > 0 ? `${percent} %` : "none";
    setText(this.noiseWords, words);
    this.noise.setAttribute("aria-valuetext", words);
    this.noise.parentElement?.classList.toggle("fault", loss > 0);
  }

  update() {
    const { speed, paused, share } = this.tiles.pace;
    const name = paused ? "Go on" : "Pause";
    if (this.play.getAttribute("aria-label") !== name) {
      this.play.setAttribute("aria-label", name);
      this.playIcon.firstElementChild?.setAttribute("d", paused ? ICONS.play : ICONS.pause);
    }
    if (document.activeElement !== this.slider) this.slider.value = String(nearest(speed));
    // A machine that cannot keep up says what share of the speed it reaches.
    const isBehind = share < 0.9 && speed > 0 && !paused;
    const percent = Math.round(share * 100);
    setText(this.speed, isBehind ? `${speedText(speed)} (${percent} %)` : speedText(speed));
    this.speed.title = isBehind ? `This machine reaches ${percent} % of that speed` : "";
    if (this.slider.getAttribute("aria-valuetext") !== speedWords(speed)) {
      this.slider.setAttribute("aria-valuetext", speedWords(speed));
    }
  }
}

/** The speed on the slider that is most like one. @param {number} speed */
function nearest(speed) {
  if (speed === 0) return SPEEDS.length - 1;
  let best = 0;
  SPEEDS.slice(0, -1).forEach((one, index) => {
    if (Math.abs(Math.log(one / speed)) < Math.abs(Math.log(SPEEDS[best] / speed))) best = index;
  });
  return best;
}
