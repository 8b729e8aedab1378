// The faults of a run that begins with what lies on the board now, as `tilenca emulate --fault` takes them.

/** @import { Command } from "./source.js" */
/** @import { LaidTile } from "./tile.js" */
/** @import { Tiles } from "./tiles.js" */
import { SIDES, sideWords } from "./source.js";

// KIND[=VALUE]@WHERE[:TIMES]
const PLACED = /^([^@:]+)@([^:]+)(.*)$/;
const WHERE = /^(\d+)(?:([NESW])|-(\d+))?$/;
/** What a hand changes with a command; a tile that is plugged in has power and whole cables, and lies straight. */
const CHANGES = new Map([
  ["noise", ["loss"]],
  ["power", ["off"]],
  ["turn", ["turn"]],
  ["skew", ["skew"]],
  ["cut", ["cut"]],
  ["shift", ["cut"]],
  ...["put", "pull", "move", "arrange"].map((name) => /** @type {[string, string[]]} */ ([name, ["off", "cut", "turn"]])),
]);

const EVERYWHERE = /^loss=([\d.]+)$/;

/** The share of bytes that faults let get lost on all cables. @param {string[]} faults */
export const lossOf = (faults) => Number(faults.map((fault) => EVERYWHERE.exec(fault)?.[1]).find(Boolean) ?? 0);

/** The same faults, but for another share of lost bytes. @param {string[]} faults @param {number} share */
export const withLoss = (faults, share) =>
  [...(share > 0 ? [`loss=${Number(share.toFixed(3))}`] : []), ...faults.filter((fault) => !EVERYWHERE.test(fault))];

/** @type {Record<string, string>} */
const WORDS = {
  cut: "a cut cable", off: "no power", turn: "turned", skew: "a clock too fast (ppm)", drift: "a drifting clock", loss: "lost bytes",
  flip: "flipped bits", delay: "a delay (ms)", reset: "a reset", remove: "taken out", adc: "noise at its pins", supply: "a supply (V)",
};
/** @type {Record<string, string>} */

/**
 * A fault in words, by the place on the board and not by a number, which changes with the tiles before it.
 * @param {string} fault
 * @param {LaidTile[]} laid the tiles that it numbers
 */
export function faultWords(fault, laid) {
  const [, what, where, times] = PLACED.exec(fault) ?? [fault, fault, "", ""];
  const [, first, side, second] = WHERE.exec(where) ?? [];
  /** @param {string} number */
  const place = (number) => {
    const tile = laid[Number(number) - 1];
    return tile ? `row ${tile.place[0] + 1}, column ${tile.place[1] + 1}` : `tile ${number}`;
  };
  const [kind, value] = what.split("=");
  const at = first ? ` at ${place(first)}` : " everywhere";
  const towards = side ? `, ${sideWords(side)}` : second ? ` to ${place(second)}` : "";
  return `${WORDS[kind] ?? kind}${value ? ` ${value}` : ""}${at}${towards}${times ? `, ${times.slice(1)} s` : ""}`;
}

/** The kinds of faults that are from now on as the board shows them. @param {Command} command */
export const kindsChangedBy = (command) => CHANGES.get(command.do) ?? [];

/**
 * The faults that were given at the start, except of the kinds that a hand has changed; and of those, what stands.
 * @param {Tiles} tiles
 * @param {string[]} given
 * @param {Set<string>} handled kinds
 * @param {number} noise the share of bytes that is lost on all cables
 */
export function faultsNow(tiles, given, handled, noise) {
  const laid = tiles.laid();
  const kept = given
    .filter((fault) => !handled.has(/^[a-z]*/.exec(fault)?.[0] ?? ""))
    .map((fault) => renumbered(fault, tiles, laid));
  const standing = standingFaults(tiles, laid, noise).filter((fault) => handled.has(/^[a-z]*/.exec(fault)?.[0] ?? ""));
  return [...new Set([...kept, ...standing])].filter(Boolean);
}

/** @param {Tiles} tiles @param {LaidTile[]} laid @param {number} noise */
function standingFaults(tiles, laid, noise) {
  const faults = withLoss([], noise);
  laid.forEach((tile, index) => {
    if (!tile.powered) faults.push(`off@${index + 1}`);
    if (tile.turned) faults.push(`turn@${index + 1}`);
    if (tile.skew) faults.push(`skew=${tile.skew}@${index + 1}`);
    for (const side of [1, 2]) {
      const other = tiles.neighbour(tile, side);
      if (other && tiles.isCut(tile, side)) faults.push(`cut@${index + 1}${SIDES[side]}`);
    }
  });
  return faults;
}

/**
 * A fault at a place, with the numbers that its tiles would have now; "" where they are no more.
 * @param {string} fault
 * @param {Tiles} tiles
 * @param {LaidTile[]} laid
 */
function renumbered(fault, tiles, laid) {
  const [, what, where, times] = PLACED.exec(fault) ?? [];
  const [, first, side, second] = WHERE.exec(where ?? "") ?? [];
  if (!first) return fault;
  /** @param {string} number */
  const indexOf = (number) => laid.findIndex((tile) => Number(tile.port.replace(/^\D*/, "")) === Number(number));
  const index = indexOf(first);
  if (index < 0) return "";
  const around = [0, 1, 2, 3].map((one) => tiles.neighbour(laid[index], one));
  if (side) return around[SIDES.indexOf(side)] ? `${what}@${index + 1}${side}${times}` : "";
  if (!second) return `${what}@${index + 1}${times}`;
  const other = indexOf(second);
  return other >= 0 && around.includes(laid[other]) ? `${what}@${index + 1}-${other + 1}${times}` : "";
}
