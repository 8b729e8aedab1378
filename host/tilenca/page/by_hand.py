"""What a hand does to emulated tiles on a board."""

from tilenca.base.errors import UsageError
from tilenca.base.sides import SIDES
from tilenca.emulator.arrangement import Arrangement
from tilenca.emulator.types import port_name
from tilenca.protocol import stream_hands as hands
from tilenca.protocol.commands import blink_command, restart_command, set_command
from tilenca.protocol.stream_fields import MOST_TILES


def tile_of(board: Arrangement, port: str) -> int:
    """The tile of that port, which lies on the board.

    Raises:
        UsageError: none does.
    """
    for tile in board.places:
        if port_name(tile) == port:
            return tile
    raise UsageError(f"no tile {port} lies on the board")


def do_by_hand(board: Arrangement, command: hands.Hand) -> None:
    """Does it, now or once more in a past that is run again.

    Raises:
        UsageError: it cannot be done.
    """
    match command:
        case hands.Put(row, col):
            if len(board.places) >= MOST_TILES:
                raise UsageError(f"the board has {MOST_TILES} tiles, which is all; take one out first")
            board.put((row, col))
        case hands.Pull(port):
            board.pull(tile_of(board, port))
        case hands.Move(port, row, col):
            board.move(tile_of(board, port), (row, col))
        case hands.Shift(ports, rows, cols):
            board.shift([tile_of(board, port) for port in ports], rows, cols)
        case hands.Arrange(cells):
            board.arrange(cells)
        case hands.Cut(port, side, on):
            board.connect(tile_of(board, port), SIDES.index(side), not on)
        case hands.Power(port, on):
            board.power(tile_of(board, port), on)
        case hands.Freeze(port, on):
            board.freeze(tile_of(board, port), on)
        case hands.Turn(port, on):
            board.turn(tile_of(board, port), on)
        case hands.Skew(port, ppm):
            board.skew(tile_of(board, port), ppm)
        case hands.Reset(port):
            board.reset(tile_of(board, port))
        case hands.Noise(loss):
            board.lose(loss)
        case hands.Blink(port, seconds):
            board.tell(tile_of(board, port), blink_command(seconds))
        case hands.Restart(port):
            board.tell(tile_of(board, port), restart_command())
        case hands.Set(name, value, port):
            for tile in sorted(board.places) if port is None else [tile_of(board, port)]:
                board.tell(tile, set_command(name, value))
