"""What a page tells emulated tiles over USB: they blink, begin again, and keep their settings."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tilenca.base.errors import UsageError
from tilenca.base.paths import DEFAULT_SHAPES
from tilenca.emulator.greeting import firmware_settings
from tilenca.page.emulated import EmulatedSource
from tilenca.protocol import stream_commands as commands
from tilenca.protocol import stream_hands as hands
from tilenca.protocol.stream import StreamEvent
from tilenca.shapes.file import load_task

TASK = load_task(DEFAULT_SHAPES)
WHITE_8 = 0b1111111


@pytest.fixture
def source(firmware: Path) -> Iterator[EmulatedSource]:
    made = EmulatedSource(firmware, firmware_settings(firmware), TASK.labels, [])
    made.take(commands.Open(((0, 0), (0, 1)), spread_s=0.0, paused=True))
    run(made, 0.5)
    yield made
    made.close()


def run(source: EmulatedSource, seconds: float) -> list[StreamEvent]:
    source.take(commands.Step(seconds))
    return source.advance(0.0)


def answers(events: list[StreamEvent]) -> dict[str, str]:
    """What each tile has acknowledged last, without checksum."""
    return {
        event["port"]: event["raw"].partition("*")[0].split(",", 2)[2]
        for event in events
        if event.get("raw", "").startswith("$ACK")
    }


def test_a_setting_is_kept_by_all_or_by_one(source: EmulatedSource) -> None:
    source.take(hands.Set("brightness", 9))
    assert answers(run(source, 0.2)) == {"tile-01": "SET,brightness,9", "tile-02": "SET,brightness,9"}
    source.take(hands.Set("period", 50, "tile-02"))
    assert answers(run(source, 0.2)) == {"tile-02": "SET,period,50"}
    with pytest.raises(UsageError, match="no tile tile-99"):
        source.take(hands.Set("period", 50, "tile-99"))


def test_a_tile_blinks_and_another_begins_again(source: EmulatedSource) -> None:
    source.take(hands.Blink("tile-01", 1))
    source.take(hands.Restart("tile-02"))
    events = run(source, 0.3)
    assert answers(events) == {"tile-01": "BLINK,1", "tile-02": "RESTART"}
    shown = [
        event["display"]["segments"]
        for event in events
        if event.get("port") == "tile-01" and "display" in event
    ]
    assert shown
    assert set(shown) <= {WHITE_8, 0}
