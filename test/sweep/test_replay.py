"""What emulated tiles have computed, computed again; a difference is found where it is."""

from dataclasses import replace

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.emulator.states import TileState
from tilenca.model.file import Model, load_model
from tilenca.simulator.engine import FastEngine
from tilenca.sweep.replay import Replay

MODEL = load_model(paths.DEFAULT_MODEL)
PAIR = [(-1, 1, -1, -1), (-1, -1, -1, 0)]
EAST, WEST = 1, 3
CHANNELS = MODEL.dimensions.channels
NOTHING = bytes(CHANNELS)


class Pair:
    """Two tiles side by side that do as the model says, as `StateWatch` would tell of them."""

    def __init__(self, model: Model = MODEL) -> None:
        self.engine = FastEngine(model)
        self.states = self.engine.seed(2)
        self.told: list[TileState] = []

    def tell(self, tile: int, heard: dict[int, bytes], began: bool = False) -> None:
        message = self.engine.message(self.states[tile]).tobytes()
        sides = tuple(heard.get(side, NOTHING) for side in range(4))
        self.told.append(
            TileState(tile, 0.01 * len(self.told), began, self.states[tile].tobytes(), message, sides)
        )

    def begin(self, tile: int) -> None:
        self.states[tile] = self.engine.seed(1)[0]
        self.tell(tile, {}, began=True)

    def update(self, tile: int, heard: dict[int, bytes]) -> None:
        own = self.engine.message(self.states[tile]).tobytes()
        inputs = own + b"".join(heard.get(side, NOTHING) for side in range(4))
        seen = np.frombuffer(inputs, np.int8)[None]
        self.states[tile] = self.engine.update(self.states[tile][None], seen)[0]
        self.tell(tile, heard)

    def message(self, tile: int, back: int = 1) -> bytes:
        """One of the messages that a tile has sent, the newest first."""
        return [state.message for state in self.told if state.tile == tile][-back]

    def replayed(self) -> Replay:
        replay = Replay(MODEL, PAIR)
        for state in self.told:
            replay.take(state)
        return replay


def ran(updates: int = 8) -> Pair:
    pair = Pair()
    pair.begin(0)
    pair.begin(1)
    for _ in range(updates):
        pair.update(0, {EAST: pair.message(1)})
        pair.update(1, {WEST: pair.message(0)})
    return pair


def test_the_same_states_are_found_the_same_also_where_messages_are_old_or_missing() -> None:
    pair = ran()
    held = pair.message(1)
    pair.update(0, {EAST: held})
    pair.update(0, {EAST: held})
    pair.update(1, {WEST: pair.message(0, back=2)})
    pair.update(0, {})
    pair.begin(0)
    pair.update(0, {EAST: pair.message(1)})
    told = pair.replayed().as_json()
    assert told["first_difference"] is None
    assert told["states"] == len(pair.told) == 24
    assert told["bytes"] == 24 * 2 * CHANNELS
    assert (told["messages"], told["read_again"]) == (20, 1)


@pytest.mark.parametrize("channel", [0, 5, CHANNELS - 1])
def test_one_wrong_bit_is_found_with_its_tile_update_and_channel(channel: int) -> None:
    pair = ran()
    state = pair.told[9]
    wrong = bytearray(state.state)
    wrong[2 * channel] ^= 1
    pair.told[9] = replace(state, state=bytes(wrong))
    replay = pair.replayed()
    found = replay.difference
    assert found is not None
    assert (found.tile, found.update, found.part, found.channel) == (2, 4, "state", channel)
    assert abs(found.on_tile - found.in_simulator) == 1
    assert replay.compared == 10, "what comes after a difference is not compared"


def test_a_message_that_was_never_sent_is_found_with_its_side() -> None:
    pair = ran()
    damaged = bytearray(pair.message(1))
    damaged[7] ^= 4
    pair.update(0, {EAST: bytes(damaged)})
    found = pair.replayed().difference
    assert found is not None
    assert (found.tile, found.part, found.channel) == (1, "E", 7)


def test_a_message_older_than_one_read_before_is_a_difference() -> None:
    pair = ran()
    pair.update(0, {EAST: pair.message(1, back=4)})
    found = pair.replayed().difference
    assert found is not None
    assert (found.tile, found.part) == (1, "E")


def test_tiles_of_another_model_differ_in_their_first_update() -> None:
    other = {name: array.copy() for name, array in MODEL.integer.items()}
    other["b3"][3] += 1
    pair = Pair(replace(MODEL, integer=other))
    pair.begin(0)
    pair.begin(1)
    pair.update(0, {EAST: pair.message(1)})
    found = pair.replayed().difference
    assert found is not None
    assert (found.tile, found.update, found.part, found.channel) == (1, 1, "state", 3)
