"""The states of emulated tiles, update by update, with the messages that each update has read.

A tile is halted where it begins to send a frame, which it does first after each update. There its memory has
the new state, the message of it, and the messages of the four neighbours that the update has read.
"""

from dataclasses import dataclass

from tilenca.base.errors import UsageError
from tilenca.base.sides import SIDES
from tilenca.emulator.array import Array
from tilenca.emulator.tile import EmulatedTile
from tilenca.protocol.constants import MAX_CHANNELS

# Link::send(Side, uint8_t, const int8_t* message, uint8_t*) of firmware/include/core/link.h.
SENDING = "_ZN7tilenca4Link4sendENS_4SideEhPKaPh"
# By the calling convention of avr-gcc: `side` is in register 22, `message` in 19:18.
SIDE_REGISTER, MESSAGE_REGISTER = 22, 18
# The message is the beginning of the cell's inputs, and its stored state lies before them: core/cell.h.
STATE_BYTES = 2 * MAX_CHANNELS
ONE = 1 << 13  # channel 0 of the seed state; the others are 0


@dataclass(frozen=True)
class TileState:
    """A tile's state after an update, or when it begins.

    Attributes:
        tile: counted from 0.
        time_s: when it began to tell it, in seconds since the array began.
        began: whether it is the seed state, which no update made.
        state: the stored state, two bytes a channel, low byte first.
        message: a byte a channel, as the neighbours get it.
        heard: the messages that the update has read, those of N, E, S and W; zeros where nobody is heard.
    """

    tile: int
    time_s: float
    began: bool
    state: bytes
    message: bytes
    heard: tuple[bytes, ...]


class StateWatch:
    """Reads the states of all tiles of an array while it runs. It changes nothing of what they do.

    Args:
        array: whose image is the tiles' firmware.
        channels: of its model.

    Raises:
        UsageError: the image is none of the tiles' firmware.
    """

    def __init__(self, array: Array, channels: int) -> None:
        self._array, self._channels = array, channels
        self._told: list[set[int]] = [set(range(len(SIDES))) for _ in array]
        try:
            for tile in array:
                tile.set_breakpoint(SENDING)
        except UsageError as error:
            raise UsageError(f"the states of these tiles cannot be read: {error}") from error

    def collect(self) -> list[TileState]:
        """The new states of the tiles that are halted, which go on with the next run."""
        found = []
        for tile in self._array.halted:
            state = self._state(tile)
            if state is not None:
                found.append(state)
            tile.resume()
        return found

    def _state(self, tile: EmulatedTile) -> TileState | None:
        """The state of a halted tile; None where it has told it on another side before.

        A state goes to each side once. So a side that is told again is told of another state.
        """
        side = tile.read_memory(SIDE_REGISTER, 1)[0]
        told = self._told[tile.index]
        if side not in told:
            told.add(side)
            return None
        self._told[tile.index] = {side}
        address = int.from_bytes(tile.read_memory(MESSAGE_REGISTER, 2), "little")
        count = self._channels
        state = tile.read_memory(address - STATE_BYTES, 2 * count)
        inputs = tile.read_memory(address, (1 + len(SIDES)) * count)
        parts = [inputs[part * count : (part + 1) * count] for part in range(1 + len(SIDES))]
        began = state == ONE.to_bytes(2, "little") + bytes(2 * count - 2)
        return TileState(tile.index, self._array.time_s, began, state, parts[0], tuple(parts[1:]))
