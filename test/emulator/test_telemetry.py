"""The lines of emulated tiles: the same as byte by byte, each with the time of the byte that completed it."""

from pathlib import Path
from typing import cast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tilenca.emulator import Array
from tilenca.emulator.telemetry import heard_from
from tilenca.emulator.tile import EmulatedTile
from tilenca.protocol.line_reader import LineReader

PIECES = st.sampled_from([b"$ASK*45\r\n", b"$AS", b"K*45", b"\r", b"\n", b"$", b"noise", b"*00", b"\xff"])


class Speaker:
    """A tile that has said these bytes, one a millisecond."""

    index = 6

    def __init__(self, said: bytes) -> None:
        self.said = said

    def read_serial_timed(self) -> tuple[bytes, list[float]]:
        return self.said, [number / 1000 for number in range(len(self.said))]


@given(st.lists(PIECES, max_size=12).map(b"".join))
def test_lines_and_their_times_are_those_of_feeding_single_bytes(said: bytes) -> None:
    reader, expected = LineReader(), []
    for number, value in enumerate(said):
        expected += [(number / 1000, raw) for raw, _ in reader.feed(bytes([value]))]
    heard = heard_from(cast(EmulatedTile, Speaker(said)), LineReader())
    assert [(line.time_s, line.raw) for line in heard] == expected
    assert {line.port for line in heard} <= {"tile-07"}


def test_a_line_that_is_cut_by_two_calls_comes_whole(firmware: Path) -> None:
    reader = LineReader()
    with Array(firmware) as array:
        lines = []
        for _ in range(400):
            array.run(0.001)
            lines += heard_from(array[0], reader)
    assert len(lines) > 5
    assert all(line.sentence is not None for line in lines)
    assert [line.time_s for line in lines] == sorted(line.time_s for line in lines)
    assert lines[0].raw.startswith(b"$HELLO")
    assert lines[-1].time_s == pytest.approx(0.4, abs=0.11)
