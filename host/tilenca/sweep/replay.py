"""Emulated tiles beside the fast simulator, state by state, with the same messages in the same order.

The emulated run gives the order alone: which tile updates next, and how far it has heard each neighbour by
then. The simulator's core computes all states and messages by itself, from the seed state on.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from tilenca.base.sides import SIDES
from tilenca.emulator.states import TileState
from tilenca.model.file import Model
from tilenca.simulator.engine import FastEngine

NOBODY = -1


@dataclass(frozen=True)
class Difference:
    """Where an emulated tile and the simulator differ.

    Attributes:
        tile: its id, from 1 in reading order.
        update: of that tile, since it was switched on; 0: the state that it begins with.
        time_s: of the emulated run.
        part: "state", or the side, N, E, S or W, from which it has read what its neighbour never sent.
        channel: the first one that differs.
        on_tile: the stored state there in units of 2^-13, or the message in units of 2^-6.
        in_simulator: the same, or of the neighbour's newest message.
    """

    tile: int
    update: int
    time_s: float
    part: str
    channel: int
    on_tile: int
    in_simulator: int


class Replay:
    """Computes what emulated tiles have computed, in their order, up to the first difference.

    Args:
        model: that the tiles have.
        neighbours: of each tile, those on N, E, S and W; -1: none.
    """

    def __init__(self, model: Model, neighbours: Sequence[Sequence[int]]) -> None:
        self._engine = FastEngine(model)
        self._neighbours = neighbours
        self._states = self._engine.seed(len(neighbours))
        self._updates = [0] * len(neighbours)
        self._sent: list[list[bytes]] = [[] for _ in neighbours]
        # Of each side, how many of the neighbour's messages had come when it read the last one.
        self._read = [[0] * len(SIDES) for _ in neighbours]
        self.compared = self.messages = self.again = 0
        self.difference: Difference | None = None

    def take(self, seen: TileState) -> None:
        """Computes the next state of a tile, and compares it; does nothing after a difference."""
        if self.difference is not None:
            return
        tile = seen.tile
        if seen.began:
            self._updates[tile] = 0
            self._states[tile] = self._engine.seed(1)[0]
        else:
            self._updates[tile] += 1
            if (heard := self._heard(seen)) is None:
                return
            own = self._engine.message(self._states[tile]).tobytes()
            inputs = np.frombuffer(own + heard, np.int8)
            self._states[tile] = self._engine.update(self._states[tile][None], inputs[None])[0]
        self._sent[tile].append(self._engine.message(self._states[tile]).tobytes())
        self.compared += 1
        self._compare(seen, "state", np.frombuffer(seen.state, "<i2"), self._states[tile])

    def _heard(self, seen: TileState) -> bytes | None:
        """The simulator's own messages that an update reads; None where the tile has read another."""
        parts = []
        for side, (neighbour, message) in enumerate(
            zip(self._neighbours[seen.tile], seen.heard, strict=True)
        ):
            sent = [] if neighbour == NOBODY else self._sent[neighbour]
            first = self._read[seen.tile][side]
            parts.append(message)
            if not any(message):
                continue  # nobody is heard
            # The last one may be read again; an earlier one may not.
            found = next((n for n in range(max(first, 1), len(sent) + 1) if sent[n - 1] == message), None)
            if found is None:
                newest = np.frombuffer(sent[-1] if sent else bytes(len(message)), np.int8)
                self._compare(seen, SIDES[side], np.frombuffer(message, np.int8), newest)
                return None
            self.messages += 1
            self.again += found == first
            self._read[seen.tile][side] = found
        return b"".join(parts)

    def _compare(self, seen: TileState, part: str, on_tile: Any, in_simulator: Any) -> None:
        places = np.flatnonzero(on_tile != in_simulator)
        if len(places):
            channel = int(places[0])
            self.difference = Difference(
                seen.tile + 1,
                self._updates[seen.tile],
                round(seen.time_s, 6),
                part,
                channel,
                int(on_tile[channel]),
                int(in_simulator[channel]),
            )

    def as_json(self) -> dict[str, Any]:
        """What was compared, and the first difference, as plain values."""
        return {
            "states": self.compared,
            "bytes": self.compared * 2 * self._engine.channels,
            "messages": self.messages,
            "read_again": self.again,
            "first_difference": None if self.difference is None else asdict(self.difference),
        }
