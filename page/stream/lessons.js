// Eight steps that teach the automaton by doing. Each has one thing to do, and the stream tells when it is done.

/** @import { Command, Place } from "./source.js" */
/** @import { Tiles } from "./tiles.js" */
import { cellsOf, known } from "./drawing.js";
import { mindsOf } from "./groups.js";

/**
 * What has happened since a step began.
 * @typedef {{runs: number, frames: number, selected: string | null}} Since
 *
 * How a step finds the board: whole (an 8 whose tiles all run), as it is, or some cells of it.
 * @typedef {{title: string, text: string, task: string, done: string, board: "whole" | "as it is" | "without one",
 *   tool: import("../components/hands.js").Tool, isDone: (tiles: Tiles, since: Since) => boolean}} Step
 * A step is done only after it was not done: what was so before it began is no deed.
 */

export const LABEL = "8";
/** The tile without which an 8 is a 9. @type {Place} */
const PULLED = [3, 0];
const SLOW = 0.011;
const FRAMES = 12;

/** What all tiles with power show; "" while they disagree. @param {Tiles} tiles */
function agreement(tiles) {
  const { counts, total } = tiles.count();
  return total > 0 && counts.size === 1 ? [...counts.keys()][0] : "";
}

/** @type {Step[]} */
export const STEPS = [
  {
    title: "A tile knows little",
    text: "Each tile is a small computer. It knows its own numbers, and what its four neighbours send it. Nobody tells it which shape it lies in.",
    task: "Look into a tile: click it, or press Enter on it.",
    done: "These bars are all it has: a score for each answer, and hidden numbers that it uses to think.",
    board: "whole",
    tool: "hand",
    isDone: (_, { selected }) => selected !== null,
  },
  {
    title: "They begin alike",
    text: "Switched on, all tiles have the same numbers. They guess, hear others, and change their minds.",
    task: "Start over (R), and watch until all agree.",
    done: "Nobody was in charge. Below you see who thought what, and a dot for every change of mind.",
    board: "as it is",
    tool: "hand",
    isDone: (tiles, { runs }) => tiles.runs > runs && agreement(tiles) !== "",
  },
  {
    title: "They talk to neighbours only",
    text: "Every 20 ms a tile computes, and sends its numbers to the tiles beside it: the dots on the cables.",
    task: "Make time 100 times slower with the slider Speed, and watch the messages.",
    done: "A message says nothing of shapes. It is the sender's numbers, one byte each.",
    board: "as it is",
    tool: "hand",
    isDone: (tiles, { frames }) => tiles.pace.speed > 0 && tiles.pace.speed <= SLOW && frames >= FRAMES,
  },
  {
    title: "Agreement travels",
    text: "A tile far away cannot see a change, but its neighbours hear of it from theirs. So what one learns goes from tile to tile.",
    task: "Take out tile 11, the left one of the fourth row: drag it out of the frame, or press Delete on it.",
    done: "An 8 without that tile is a 9, and all found out, also those at the other end.",
    board: "whole",
    tool: "hand",
    isDone: (tiles) => tiles.laid().length < 16 && ![LABEL, "", "-"].includes(agreement(tiles)),
  },
  {
    title: "And back again",
    text: "A tile that is plugged in begins from nothing. It asks nobody for the answer: the others send what they always send.",
    task: "Put the tile in again: click the empty place, or press Enter on it.",
    done: "The newcomer and all others show an 8. Nobody told them: together they see it.",
    board: "without one",
    tool: "hand",
    isDone: (tiles) => tiles.laid().length === 16 && agreement(tiles) === LABEL,
  },
  {
    title: "A dead tile",
    text: "A tile without power falls silent. Its neighbours wait six periods, then take it for an empty place and do without it.",
    task: "Look into any tile, and choose Power off.",
    done: "The rest agree on what is left. It may be another digit, if that looks more like it.",
    board: "whole",
    tool: "hand",
    isDone: (tiles) => tiles.laid().some((tile) => !tile.powered && tile.modelId !== "") && // it had power
       agreement(tiles) !== "",
  },
  {
    title: "Two groups, two minds",
    text: "Tiles lie still, but cables can be cut. Where no message comes through, nobody knows of the others.",
    task: "With the knife (K), cut the 8 into two groups: a stroke across two cables, below the middle row. By keyboard: Shift and an arrow key.",
    done: "Each group agrees with itself. They may disagree with each other, and cannot know it.",
    board: "whole",
    tool: "knife",
    isDone: (tiles) => tiles.cut.size > 0 && mindsOf(tiles).length > 1,
  },
  {
    title: "What is no digit",
    text: "They were trained to say so where they see none: with a dash.",
    task: "Draw (D) something that is no digit, until all show a dash.",
    done: "That is all. Everything you saw was the firmware of real tiles, and you can build them.",
    board: "whole",
    tool: "pencil",
    isDone: (tiles) => agreement(tiles) === "-",
  },
];

/** Whether the board is whole. @param {Tiles} tiles */
export function isWhole(tiles) {
  const laid = tiles.laid();
  return known(laid.map((tile) => tile.place), tiles.drawings)?.label === LABEL && laid.length === 16 &&
    tiles.cut.size === 0 && laid.every((tile) => tile.powered && !tile.frozen);
}

/** Whether the board is as a step needs it, after its preparation. @param {Step} step @param {Tiles} tiles @param {Since} since */
export function isReady(step, tiles, since) {
  if (step.board === "without one") return tiles.laid().length === 15;
  return step.board === "as it is" || tiles.runs >= since.runs;
}

/** The places of the 8. @param {Tiles} tiles @returns {Place[]} */
export function eight(tiles) {
  const drawing = tiles.drawings.find(({ label, rows }) => label === LABEL && cellsOf(rows).length === 16);
  return drawing ? cellsOf(drawing.rows) : [];
}

/**
 * What makes the board as a step needs it; null where it has to begin anew.
 * @param {Step} step @param {Tiles} tiles
 * @param {boolean} isNew whether the tiles are about to be others
 * @returns {Command[] | null}
 */
export function preparation(step, tiles, isNew = false) {
  if (step.board === "as it is") return [];
  if (step.board === "whole") return isWhole(tiles) && !isNew ? [] : null;
  if (tiles.laid().length === 15 && !isNew) return [];
  return [{ do: "arrange", cells: eight(tiles).filter(([row, col]) => row !== PULLED[0] || col !== PULLED[1]) }];
}
