"""What the page is told: news once, and after a jump all that there is."""

import tracemalloc
from collections.abc import Iterator
from pathlib import Path

import pytest

from tilenca.base.sides import EAST
from tilenca.emulator.arrangement import Arrangement
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.greeting import firmware_settings
from tilenca.page.teller import VOICE_BYTES, Teller
from tilenca.protocol.stream import StreamEvent
from tilenca.shapes.file import Shape

THREE = Shape("-", ("###",), "-")


@pytest.fixture
def told(firmware: Path) -> Iterator[tuple[Emulation, Arrangement, Teller]]:
    settings = EmulationSettings(boot_spread_s=0.0)
    emulation = Emulation(THREE, tuple("0123456789"), firmware, settings, firmware_settings(firmware))
    with emulation.array:
        board = Arrangement(emulation, THREE.cells)
        yield emulation, board, Teller(emulation.array, board)


def kinds(events: list[StreamEvent]) -> set[str]:
    return {key for event in events for key in event} - {"time", "port", "side", "reason"}


def test_news_is_told_once(told: tuple[Emulation, Arrangement, Teller]) -> None:
    emulation, board, teller = told
    assert [event["place"] for event in teller.places() if "place" in event] == [[0, 0], [0, 1], [0, 2]]
    assert teller.places() == []
    emulation.pass_time(0.2)
    assert kinds(teller.look(frames=True)) == {"frame", "raw", "display"}
    assert teller.look(frames=True) == []
    board.connect(1, EAST, whole=False)
    assert [(event["port"], event["side"], event["cable"]) for event in teller.places()] == [
        ("tile-02", "E", "cut")
    ]


def test_a_moment_stays_as_it_was_and_its_voices_are_as_large_as_is_said(
    told: tuple[Emulation, Arrangement, Teller],
) -> None:
    emulation, _, teller = told
    emulation.pass_time(0.2)
    teller.look(frames=False)
    said = teller.save()
    before = [dict(voice.last) for voice in said]
    tracemalloc.start()
    many = [teller.save() for _ in range(100)]
    size = tracemalloc.get_traced_memory()[0] / sum(map(len, many))
    tracemalloc.stop()
    assert 0.3 * VOICE_BYTES < size < 1.5 * VOICE_BYTES
    emulation.pass_time(0.5)
    teller.look(frames=False)
    assert [voice.last for voice in said] == before
    assert teller.save()[0].last != before[0]


def test_after_a_jump_all_is_told_with_the_last_lines(
    told: tuple[Emulation, Arrangement, Teller],
) -> None:
    emulation, board, teller = told
    emulation.pass_time(0.2)
    teller.look(frames=False)
    board.connect(1, EAST, whole=False)
    moment, said, before = board.save(), teller.save(), teller.all()
    board.pull(0)
    emulation.pass_time(0.3)
    teller.look(frames=False)
    board.restore(moment)
    teller.restore(said)
    assert teller.all() == before
    assert kinds(before) == {"place", "open", "cable", "raw", "display"}
    lines = [(event["port"], event["raw"].split(",")[0]) for event in before if "raw" in event]
    assert {("tile-01", "$HELLO"), ("tile-03", "$TILE")} <= set(lines)
    assert all(event["time"] <= 0.21 for event in before)
    assert teller.look(frames=False) == []


def test_what_a_tile_showed_is_over_when_it_starts_anew(
    told: tuple[Emulation, Arrangement, Teller],
) -> None:
    """Reset, moved, or taken out and put in at once: until it speaks again nothing is known of it."""
    emulation, board, teller = told
    emulation.pass_time(0.3)
    teller.look(frames=False)
    assert [event["port"] for event in teller.all() if event.get("raw", "").startswith("$TILE")] == [
        "tile-01", "tile-02", "tile-03"
    ]  # fmt: skip
    moment, said = board.save(), teller.save()
    board.reset(0)
    board.move(1, (1, 0))
    news = [(event["port"], event["open"]) for event in teller.places() if "open" in event]
    assert news == [(port, on) for port in ("tile-01", "tile-02") for on in (False, True)]
    emulation.pass_time(0.001)  # no tile has booted by then
    silent = [event["port"] for event in teller.all() if event.get("raw", "").startswith("$TILE")]
    assert silent == ["tile-03"]
    board.restore(moment)
    teller.restore(said)
    assert len([event for event in teller.all() if event.get("raw", "").startswith("$TILE")]) == 3
