// What a tile's program does: one instruction after the other, with registers and variables. Time stands meanwhile.

/** @import { Tile } from "../stream/tile.js" */
/** @import { Tiles } from "../stream/tiles.js" */
import { flagsOf, inHex, pairs, plainName, valueText } from "../stream/chip.js";
import { element, setText } from "./dom.js";

const COUNTS = [1, 10, 100];
const MOST_SHOWN = 12; // variables, until one looks for others

export class Program {
  /** @param {Tiles} tiles @param {(port: string, count: number) => void} instruct */
  constructor(tiles, instruct) {
    this.tiles = tiles;
    this.instruct = instruct;
    this.port = "";
    /** Tile and time of what is shown, or asked for. */
    this.asked = "";
    /** @type {import("../stream/chip.js").Chip | null} */
    this.shown = null;
    this.buttons = COUNTS.map((count) => element(
      "button", { type: "button", title: count === 1 ? "One instruction (I)" : "", onclick: () => this.step(count) },
      count === 1 ? "One instruction" : String(count),
      element("span", { class: "visually-hidden" }, count === 1 ? "" : " instructions"),
    ));
    this.place = element("p", { class: "summary", role: "status" });
    this.facts = element("dl", { class: "facts" });
    this.flags = element("ul", { class: "flags", "aria-label": "Flags" });
    this.registers = element("ol", { class: "registers", start: 0, "aria-label": "Registers r0 to r31" });
    this.filter = element("input", {
      type: "search", class: "number", "aria-label": "Look for a variable", placeholder: "Look for a variable",
      oninput: () => this.showVariables(),
    });
    this.variables = element("dl", { class: "facts variables", tabindex: 0, "aria-label": "Variables" }); // it scrolls
    this.body = element("div", { class: "program-body" },
      element("div", { class: "steps-of-program" }, ...this.buttons), this.place, this.facts, this.flags, this.registers,
      element("h3", {}, "Variables"), this.filter, this.variables);
    this.hint = element("p", { class: "summary" });
    this.root = element(
      "details", { class: "program", "data-needs": "instruct", ontoggle: () => this.update() },
      element("summary", {}, "Program"), this.hint, this.body,
    );
  }

  /** @param {string} port of the tile */
  choose(port) {
    this.port = port;
    this.asked = "";
    this.shown = this.tiles.byPort.get(port)?.chip ?? null; // of before: it is asked for anew
  }

  /** Executes so many instructions. @param {number} count */
  step(count) {
    if (this.buttons[0].disabled) return;
    this.root.open = true;
    this.instruct(this.port, count);
  }

  update() {
    const tile = this.tiles.byPort.get(this.port);
    const why = !tile?.powered ? "It has no power." : this.tiles.pace.paused ? "" : "Pause the run to look into the program, and to take single instructions.";
    for (const button of this.buttons) button.disabled = why !== "";
    if (!this.root.open) return;
    this.hint.hidden = why === "";
    setText(this.hint, why);
    this.body.hidden = why !== "";
    if (why || !tile) return;
    const now = `${this.port} ${this.tiles.time} ${this.tiles.jumps}`;
    if (tile.chip && tile.chip !== this.shown) this.show(tile);
    else if (now !== this.asked) this.instruct(this.port, 0);
    this.asked = now;
  }

  /** @param {Tile} tile */
  show(tile) {
    const { chip } = tile;
    if (!chip) return;
    const before = this.shown;
    this.shown = chip;
    setText(this.place, `Next: ${inHex(chip.pc, 5)}${chip.function ? ` in ${plainName(chip.function)}` : ""}`);
    const facts = [
      ["Code", pairs(chip.code).join(" ")], ["Cycles", `${chip.cycles}${before && before.cycles <= chip.cycles ? `, ${chip.cycles - before.cycles} more` : ""}`],
      ["Stack", `${inHex(chip.sp, 4)}: ${pairs(chip.stack).slice(0, 8).join(" ")}`],
    ];
    this.facts.replaceChildren(...facts.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
    this.flags.replaceChildren(...flagsOf(chip.sreg).map(([name, isSet]) =>
      element("li", { class: isSet ? "on" : "" }, name, element("span", { class: "visually-hidden" }, isSet ? " set" : " clear"))));
    const old = before ? pairs(before.registers) : [];
    this.registers.replaceChildren(...pairs(chip.registers).map((value, index) =>
      element("li", {}, element("span", { class: "name" }, `r${index}`), " ",
        element("span", { class: old.length && old[index] !== value ? "changed" : "" }, value))));
    this.showVariables(before);
  }

  /** @param {import("../stream/chip.js").Chip | null} [before] */
  showVariables(before = null) {
    const wanted = this.filter.value.trim().toLowerCase();
    const old = new Map((before?.variables ?? []).map(([name, address, , data]) => [`${name} ${address}`, data]));
    const all = (this.shown?.variables ?? []).map(([name, address, size, data]) => ({
      name: plainName(name), address, text: valueText(size, data), isNew: old.has(`${name} ${address}`) && old.get(`${name} ${address}`) !== data,
    }));
    const found = all.filter(({ name }) => name.toLowerCase().includes(wanted));
    const shown = wanted ? found : [...found.filter(({ isNew }) => isNew), ...found.filter(({ isNew }) => !isNew)].slice(0, MOST_SHOWN);
    this.variables.replaceChildren(...shown.flatMap(({ name, address, text, isNew }) => [
      element("dt", { title: inHex(address, 4) }, name), element("dd", { class: isNew ? "changed" : "" }, text),
    ]));
    if (shown.length < found.length) {
      this.variables.append(element("dt", {}, "…"), element("dd", {}, `${found.length - shown.length} more: look for one by its name`));
    }
  }
}
