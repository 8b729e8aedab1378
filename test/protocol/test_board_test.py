"""The lines of the board test are told from damaged sentences."""

import re

import pytest

from tilenca.base import paths
from tilenca.protocol.board_test import board_test_text

LINES = [
    b"board test: press the button to go on",
    b"button: pressed",
    b"colours: only red PB5",
    b"display: only segment a PH4",
    b"LEDs: only LED 1 PK0",
    b"side N: FAIL, heard nothing: no plug, no tile, or a broken line to PD2",
]


@pytest.mark.parametrize("line", LINES)
def test_a_whole_line_is_its_own_text(line: bytes) -> None:
    assert board_test_text(line) == line.decode()


@pytest.mark.parametrize(
    "line",
    [
        b"",
        b"side N: ",
        b"side X: pass",
        b"ide N: pass",
        b" side N: pass",
        b"side N: p\xe4ss",
        b"side N: pass\r",
        b"$TILE,7,lost its dollar*00",
    ],
)
def test_all_else_is_not(line: bytes) -> None:
    assert board_test_text(line) is None


def test_the_firmware_begins_its_lines_so() -> None:
    sources = (paths.FIRMWARE / "src" / "board_test").glob("*.cpp")
    text = "".join(source.read_text(encoding="utf-8") for source in sources)
    for beginning in {re.match(rb"\w+", line)[0].decode() for line in LINES}:  # type: ignore[index]
        assert re.search(rf'"{beginning}\b', text), beginning
