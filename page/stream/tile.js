// What the page knows of one tile, and what it learns from each of its sentences.

/** @import { Place } from "./source.js" */
/** @import { BoardSentence, LinkSentence, Sentence, TimeSentence } from "./sentences.js" */

/**
 * How a link is, as the monitor marks it, and the share of frames that arrive whole.
 * @typedef {[string, number | null]} LinkHealth
 *
 * @typedef {{
 *   port: string, number: number, place: Place | null, powered: boolean, reason: string, frozen: boolean,
 *   turned: boolean, skew: number,
 *   segments: number, rgb: number[], leds: string,
 *   label: string, margin: number | null, links: string, state: number[], updates: number, uptimeMs: number,
 *   modelId: string, channels: number, classes: number, periodMs: number, brightness: number,
 *   link: Record<string, LinkSentence>, time: TimeSentence | null, board: BoardSentence | null,
 *   error: string, countSide: number, chip: import("./chip.js").Chip | null,
 *   trouble: string, health: Record<string, LinkHealth>,
 * }} Tile
 *
 * @typedef {Tile & {place: Place}} LaidTile
 */

/** @param {string} port @returns {Tile} */
export function newTile(port) {
  return {
    port, number: Number(/(\d+)\D*$/.exec(port)?.[1] ?? 0), place: null, powered: false, reason: "", frozen: false,
    turned: false, skew: 0,
    segments: 0, rgb: [0, 0, 0], leds: "----",
    label: "", margin: null, links: "----", state: [], updates: 0, uptimeMs: 0,
    modelId: "", channels: 0, classes: 0, periodMs: 0, brightness: 0, link: {}, time: null, board: null, error: "", countSide: -1, chip: null,
    trouble: "", health: {},
  };
}

/** What it has shown and counted is over: it has no power, or starts. @param {Tile} tile */
export function forget(tile) {
  Object.assign(tile, { updates: 0, margin: null, state: [], links: "----", countSide: -1 });
}

/**
 * Adds a sentence of the tile.
 * @param {Tile} tile @param {Sentence | null} sentence @param {boolean} asked of a HELLO: it was asked for, and is no start
 * @returns {string | null} the label that it shows from now on; null where the sentence does not tell it
 */
export function hear(tile, sentence, asked = false) {
  switch (sentence?.name) {
    case "HELLO":
      Object.assign(tile, {
        modelId: sentence.modelId, channels: sentence.channels, classes: sentence.classes, periodMs: sentence.periodMs,
        brightness: sentence.brightness, frozen: sentence.updates > 0, error: asked ? tile.error : "",
      });
      return null;
    case "TILE":
      Object.assign(tile, {
        updates: sentence.updates, uptimeMs: sentence.uptimeMs, margin: sentence.margin, links: sentence.links,
        state: sentence.state,
      });
      return sentence.label;
    case "LINK":
      tile.link[sentence.side] = sentence;
      return null;
    case "TIME":
      tile.time = sentence;
      return null;
    case "BOARD":
      tile.board = sentence;
      return null;
    case "ERROR":
      tile.error = `${sentence.code}: ${sentence.text}`;
      return null;
    case "ACK":
      hearAnswer(tile, sentence.fields);
      return null;
    default:
      return null;
  }
}

/** @param {Tile} tile @param {string[]} fields of an acknowledgement: the command's name and its fields */
function hearAnswer(tile, [command, name, value]) {
  if (command !== "SET") return;
  if (name === "updates") tile.frozen = value !== "0";
  if (name === "period") tile.periodMs = Number(value);
  if (name === "brightness") tile.brightness = Number(value);
}
