"""What `tilenca devices --learn` makes of tiles that answer, of some that do not, and of the file so far."""

from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import pytest
from test_asking import HELLO, Device

from tilenca.cli import main
from tilenca.portlock import port_lock
from tilenca.protocol import AckSentence, LinkSentence, format_sentence
from tilenca.tilesfile import Place, read_tiles, write_tiles


class Tile(Device):
    """A tile that tells of all its sides, says who it is if asked, and takes any id."""

    def __init__(
        self, tile: int, east: int | None = None, west: int | None = None, period_ms: int = 20
    ) -> None:
        sides: list[tuple[str, int | None, str | None]] = [("N", None, None), ("S", None, None)]
        sides += [("E", east, "W" if east else None), ("W", west, "E" if west else None)]
        links = [LinkSentence(tile, 0, side, 9, 8, 0, 0, 0, 12, 0, other, far) for side, other, far in sides]
        hello = format_sentence(replace(HELLO, tile=tile, period_ms=period_ms))

        def answer(line: bytes, count: int) -> bytes:
            if not line.startswith(b"$SET,id,"):
                return hello
            new = line.removeprefix(b"$SET,id,").partition(b"*")[0].decode()
            return format_sentence(AckSentence(int(new), "SET", ("id", new)))

        super().__init__(b"".join(map(format_sentence, links)), answer)


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def learn(file: Path, *arguments: str) -> int:
    return main(["devices", "--learn", "--tiles", str(file), *arguments])


def test_the_id_of_a_board_that_is_plugged_in_and_does_not_answer_is_not_free(
    stack: ExitStack, tmp_path: Path
) -> None:
    file = tmp_path / "tiles.toml"
    silent, fresh = (stack.enter_context(device).port for device in (Device(), Tile(0)))
    write_tiles(file, [Place(1, f"port:{silent}", 0, 0)])
    with port_lock(silent, "screen"):
        assert learn(file, "--assign", "--port", silent, "--port", fresh) == 1
    assert {place.tile: place.board for place in read_tiles(file)} == {
        1: f"port:{silent}",
        2: f"port:{fresh}",
    }
