// One sentence: what the tiles think together.

/** @import { Tiles } from "../stream/tiles.js" */
import { known } from "../stream/drawing.js";
import { mindsOf } from "../stream/groups.js";
import { named } from "../stream/source.js";
import { byId, setText } from "./dom.js";

// A sentence that stands so long is said aloud.
const SETTLED_MS = 1200;
const FEW = 3; // groups that are told one by one
const LONG = 24; // characters; more have to be smaller, so that they stand in one line

/**
 * The sentence, and the label that most tiles show.
 * @param {Tiles} tiles
 * @returns {{text: string, label: string, agreed: boolean}}
 */
export function verdictOn(tiles) {
  const { counts, total } = tiles.count();
  const dark = counts.get("") ?? 0;
  const laid = tiles.laid();
  const lost = tiles.kind === "watched" ? laid.filter((tile) => tile.trouble).length : 0;
  const away = lost ? `, ${lost} ${lost === 1 ? "is" : "are"} not heard` : "";
  counts.delete("");
  const ranked = [...counts].sort((a, b) => b[1] - a[1]);
  if (tiles.source === "building") return { text: `Building the firmware of ${tiles.model}`, label: "", agreed: false };
  if (tiles.source === "failed") return { text: `The firmware of ${tiles.model} was not built`, label: "", agreed: false };
  if (total === 0) {
    if (tiles.kind === "watched") return { text: laid.length ? "No tile is heard" : "No tile yet", label: "", agreed: false };
    const text = laid.length ? "No tile has power" : "The board is empty";
    const boot = laid.length > 0 && tiles.history.changes.length === 0;
    return { text: boot ? "The tiles boot" : text, label: "", agreed: false };
  }
  if (!ranked.length) return { text: `The tiles boot${away}`, label: "", agreed: false };
  const [label, most] = ranked[0];
  const off = tiles.kind === "watched" ? 0 : laid.filter((tile) => !tile.powered).length;
  const without = off ? `, ${off} ${off === 1 ? "has" : "have"} no power` : "";
  if (most === total) {
    const who = total === 1 ? "One tile shows" : `All ${total} tiles show`;
    const drawn = known(laid.map((tile) => tile.place), tiles.drawings);
    const but = drawn && drawn.label !== label ? `, and it was drawn as ${drawn.label}` : "";
    return { text: `${who} ${named(label)}${but}${without}${away}`, label, agreed: true };
  }
  const groups = mindsOf(tiles);
  if (groups.length) {
    const each = groups.map(([one, ...others]) => `${others.length + 1} show${others.length ? "" : "s"} ${named(tiles.shown(one))}`);
    const told = groups.length > FEW ? "each of one mind" : each.join(", ");
    return { text: `${groups.length} groups: ${told}${without}${away}`, label, agreed: true };
  }
  const waiting = dark ? `, ${dark} still ${dark === 1 ? "boots" : "boot"}` : "";
  return { text: `${most} of ${total} show ${named(label)}${waiting}${without}${away}`, label, agreed: false };
}

export class Verdict {
  constructor() {
    this.line = byId("verdict");
    this.clock = byId("clock");
    this.said = "";
    this.text = "";
    this.since = 0;
    this.version = -1;
    this.buildsSince = 0;
  }

  /** @param {Tiles} tiles @param {number} now */
  update(tiles, now) {
    if (tiles.version !== this.version) {
      this.version = tiles.version;
      const { text, agreed } = verdictOn(tiles);
      if (text !== this.text) this.since = now;
      this.text = text;
      setText(this.line, text);
      this.line.classList.toggle("agreed", agreed);
      this.line.classList.toggle("long", text.length > LONG);
    }
    if (this.text !== this.said && now - this.since > SETTLED_MS) {
      this.said = this.text;
      setText(byId("announce"), this.text);
    }
    if (tiles.source === "building") {
      this.buildsSince ||= now;
      setText(this.clock, `${Math.floor((now - this.buildsSince) / 1000)} s`);
      return;
    }
    this.buildsSince = 0;
    setText(this.clock, `${tiles.time.toFixed(tiles.pace.speed && tiles.pace.speed < 0.02 ? 4 : 2)} s`);
  }
}
