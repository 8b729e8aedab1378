"""Many ports read at once."""

import termios
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from support.tile_port import Tile
from tilenca.fleet.reader import PortReader
from tilenca.fleet.state import Event
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import (
    TileSentence,
)


@pytest.fixture
def tiles() -> Iterator[list[Tile]]:
    with ExitStack() as stack:
        yield [stack.enter_context(Tile(number)) for number in (1, 2, 3)]


def test_leaving_a_port_does_not_lower_dtr(tiles: list[Tile]) -> None:
    with PortReader([tiles[0].port]) as reader:
        reader.poll(0.0)
        flags = termios.tcgetattr(tiles[0]._slave)[2]
    assert not flags & termios.HUPCL


def test_a_hundred_bursts_from_many_ports_lose_nothing(tiles: list[Tile]) -> None:
    with PortReader([tile.port for tile in tiles]) as reader:
        assert len(reader.poll(0.0)) == 3
        heard: list[Event] = []
        for _ in range(100):
            for tile in tiles:
                tile.say()
            heard += reader.poll(0.0)
        for _ in range(1000):
            if len(heard) == 300:
                break
            heard += reader.poll(1.0)
    for tile in tiles:
        mine = [event for event in heard if event.port == tile.port]
        assert [
            event.sentence.updates
            for event in mine
            if isinstance(event, Heard) and isinstance(event.sentence, TileSentence)
        ] == list(range(1, 101))
