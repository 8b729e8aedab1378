// What a hand does to the tiles of a board: the twin of `tilenca.page.by_hand`.
import { TilencaError } from "../module.js";
import { MOST_TILES } from "./commands.js";
import { sorted } from "./faults.js";
import { blinkCommand, restartCommand, setCommand } from "./settings.js";
import { SIDES } from "./sides.js";
import { portName } from "./teller.js";

/** @typedef {import("./board.js").Board} Board */

/** The tile of that port, which lies on the board. @param {Board} board @param {string} port */
export function tileOf(board, port) {
  for (const tile of board.places.keys()) if (portName(tile) === port) return tile;
  throw new TilencaError(`no tile ${port} lies on the board`);
}

/**
 * Does it, now or once more in a past that is run again.
 * @param {Board} board
 * @param {import("./commands.js").Command} command
 */
export function doByHand(board, command) {
  const tile = (/** @type {string} */ port) => tileOf(board, port);
  switch (command.do) {
    case "put":
      if (board.places.size >= MOST_TILES) {
        throw new TilencaError(`the board has ${MOST_TILES} tiles, which is all; take one out first`);
      }
      return board.put([command.row, command.col]);
    case "pull":
      return board.pull(tile(command.port));
    case "move":
      return board.move(tile(command.port), [command.row, command.col]);
    case "shift":
      return board.shift(command.ports.map(tile), command.rows, command.cols);
    case "arrange":
      return board.arrange(sorted(command.cells));
    case "cut":
      return board.connect(tile(command.port), SIDES.indexOf(command.side), !command.on);
    case "power":
      return board.faults.power(tile(command.port), command.on);
    case "freeze":
      return board.freeze(tile(command.port), command.on);
    case "turn":
      return board.faults.turn(tile(command.port), command.on);
    case "skew":
      return board.faults.skew(tile(command.port), command.ppm);
    case "reset":
      return board.faults.reset(tile(command.port));
    case "noise":
      return board.faults.spoilAll("loss", command.loss);
    case "blink":
      return board.tell(tile(command.port), blinkCommand(command.seconds));
    case "restart":
      return board.tell(tile(command.port), restartCommand());
    case "set": {
      const tiles = command.port === null ? [...board.places.keys()].sort((one, other) => one - other) : [tile(command.port)];
      for (const one of tiles) board.tell(one, setCommand(command.name, command.value));
      return undefined;
    }
    default:
      throw new TilencaError(`${command.do}: whoever stands before the source takes it`);
  }
}
