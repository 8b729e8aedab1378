// What stands behind the page: anything that tells of tiles in the stream's events and takes its commands
// (docs/PROTOCOL.md section 7). A server with the native emulator is one; components know none of them.

/**
 * @typedef {{label: string, segments: number, rgb: number[]}} Look
 * @typedef {{name: string, label: string, rows: string[]}} Drawing
 * @typedef {{name: string, id: string, labels: string[]}} Model
 * @typedef {[number, number]} Place
 *
 * One event: a time, and exactly one of the other subjects.
 * @typedef {{
 *   time: number, port?: string, side?: string,
 *   stream?: number, source?: string, of?: string, takes?: string[], looks?: Look[], drawings?: Drawing[], period_ms?: number | null,
 *   most_tiles?: number, most_place?: number, models?: Model[], model?: string,
 *   run?: {seed: number, shape: string, tiles: number, began?: number},
 *   jump?: {from: number, forget?: boolean},
 *   deed?: Command,
 *   pace?: {speed: number, paused: boolean, share: number, end?: number},
 *   place?: Place | null, tile?: number,
 *   cable?: "whole" | "cut",
 *   chip?: import("./chip.js").Chip,
 *   fault?: {turned: boolean, skew: number},
 *   raw?: string, asked?: boolean,
 *   open?: boolean, reason?: string,
 *   display?: {segments: number, rgb: number[], leds: string},
 *   frame?: string,
 *   classes?: Look[],
 *   health?: {trouble: string, links: Record<string, [string, number | null]>},
 *   note?: string, bad?: boolean,
 *   refused?: string,
 * }} StreamEvent
 *
 * @typedef {{do: string, [field: string]: unknown}} Command
 *
 * @typedef {{
 *   send: (command: Command) => void,
 *   close: () => void,
 * }} Source
 *
 * @typedef {{
 *   onEvents: (events: StreamEvent[]) => void,
 *   onOpen: () => void,
 *   onWhole?: (events: StreamEvent[]) => void,
 *   onLost: (seconds: number, code: number) => void,
 * }} Listener
 */

export const STREAM_VERSION = 1;
/** Why a server that was reached closes (codes of RFC 6455). */
export const WRONG_TOKEN = 1008;
export const BROKE_OFF = 1011;
export const TOO_MANY_PAGES = 1013;
export const SIDES = "NESW";
/** A label in words. @param {string} label */
export const named = (label) => (label === "-" ? "a dash" : label);

const SIDE_WORDS = ["north", "east", "south", "west"];
/** A side in words. @param {string | number} side its letter or number */
export const sideWords = (side) => SIDE_WORDS[typeof side === "number" ? side : SIDES.indexOf(side)] ?? "";
/** Rows and columns from a tile to its neighbour on each side. @type {Place[]} */
export const OFFSETS = [[-1, 0], [0, 1], [1, 0], [0, -1]];
