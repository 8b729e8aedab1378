"""Frames on cables that come and go."""

from pathlib import Path

from tilenca.base import paths
from tilenca.emulator import EAST, NORTH, SOUTH, WEST, Array
from tilenca.emulator.array import Link
from tilenca.emulator.traffic import Traffic
from tilenca.model.file import load_model
from tilenca.protocol.frames import cobs_decode, decode_payload

ROW: Link = (0, EAST, 1, WEST)
COLUMN: Link = (0, SOUTH, 2, NORTH)
CHANNELS = load_model(paths.DEFAULT_MODEL).dimensions.channels


def test_both_directions_of_each_cable_are_heard_in_order(firmware: Path) -> None:
    with Array(firmware, 3, [ROW, COLUMN]) as array:
        traffic = Traffic(array, [ROW, COLUMN])
        array.run(0.3)
        frames = traffic.read()
        assert traffic.read() == []
    ends = {(frame.tile, frame.side) for frame in frames}
    assert ends == {(0, EAST), (1, WEST), (0, SOUTH), (2, NORTH)}
    assert [frame.time_s for frame in frames] == sorted(frame.time_s for frame in frames)
    heard = [decode_payload(cobs_decode(frame.data) or b"", CHANNELS) for frame in frames]
    assert all(one is not None and one.side == frame.side for one, frame in zip(heard, frames, strict=True))


def test_a_cable_is_heard_from_when_it_is_watched_until_it_is_forgotten(firmware: Path) -> None:
    with Array(firmware, 2) as array:
        traffic = Traffic(array)
        array.run(0.1)
        array.link(*ROW)
        traffic.watch(ROW)
        array.run(0.1)
        assert {(frame.tile, frame.side) for frame in traffic.read()} == {(0, EAST), (1, WEST)}
        traffic.forget(ROW)
        traffic.forget(ROW)  # again does nothing
        array.run(0.1)
        assert traffic.read() == []
