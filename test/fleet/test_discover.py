"""What `tilenca devices --learn` makes of tiles that answer, of some that do not, and of the file so far."""

import json
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import pytest

from support.scripted_port import HELLO, Device
from tilenca.cli import main
from tilenca.fleet import discover
from tilenca.fleet.lock import port_lock
from tilenca.fleet.tiles_file import Place, read_tiles, write_tiles
from tilenca.protocol.sentences import AckSentence, LinkSentence, format_sentence


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
    stack: ExitStack, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, gone = tmp_path / "tiles.toml", f"port:{tmp_path}/gone"
    silent, fresh = (stack.enter_context(device).port for device in (Device(), Tile(0)))
    write_tiles(file, [Place(1, f"port:{silent}", 0, 0), Place(3, gone, 0, 2)])
    with port_lock(silent, "screen"):
        assert learn(file, "--assign", "--json", "--port", silent, "--port", fresh) == 1
    assert {place.tile: place.board for place in read_tiles(file)} == {
        1: f"port:{silent}",
        2: f"port:{fresh}",
        3: gone,
    }
    missing = json.loads(capsys.readouterr().out)["missing"]
    assert [(place["tile"], place["board"]) for place in missing] == [(3, gone)], (
        "it is in the file, not here"
    )


def test_slow_tiles_are_heard_as_long_as_they_take(
    stack: ExitStack, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(discover, "LISTEN_S", 0.0)
    devices = [Tile(1, east=2, period_ms=1000), Tile(2, west=1, period_ms=1000)]
    ports = [f"--port={stack.enter_context(device).port}" for device in devices]
    file = tmp_path / "tiles.toml"
    assert learn(file, *ports) == 0
    assert "do not touch" not in capsys.readouterr().err
    assert [(place.tile, place.row, place.col) for place in read_tiles(file)] == [(1, 0, 0), (2, 0, 1)]


def test_what_is_no_file_or_has_no_place_to_be_kept_is_left_alone(
    stack: ExitStack, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    device = stack.enter_context(Tile(0))
    folder, file = tmp_path / "folder", tmp_path / "tiles.toml"
    folder.mkdir()
    assert learn(folder, "--port", device.port) == 2
    assert folder.is_dir()
    file.write_text("mine, new")
    aside = tmp_path / "tiles.toml.old"
    aside.write_text("mine, old")
    assert learn(file, "--assign", "--port", device.port) == 2
    assert f"remove {aside}" in capsys.readouterr().err
    assert (file.read_text(), aside.read_text()) == ("mine, new", "mine, old")
    assert not device.heard, "its id is what it was"
