"""What silent sides point at, on emulated tiles in which one thing each is wrong."""

from collections.abc import Callable

import pytest

from support.line_faults import Vandal, noise
from tilenca.base.paths import FIRMWARE_ELF
from tilenca.base.sides import EAST, WEST
from tilenca.emulator import Array
from tilenca.emulator.telemetry import heard_from
from tilenca.fleet.events import News, Reporter
from tilenca.fleet.grid import Grid
from tilenca.fleet.side_hints import SUPPLY_REMEDY, line_hints
from tilenca.fleet.state import Fleet, PortNews
from tilenca.fleet.tiles_file import Place
from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.sentences import BoardSentence
from tilenca.protocol.settings import settings_block

STEP_S = 0.1
ROW = [(0, EAST, 1, WEST), (1, EAST, 2, WEST)]
PLACES = [Place(number + 1, f"port:{number}", 0, number) for number in range(3)]


def watched(
    prepare: Callable[[Array], object],
    seconds: float = 6.0,
    links: list[tuple[int, int, int, int]] = ROW,
    go_on: Callable[[Array], object] = lambda array: None,
) -> list[News]:
    """The bad news of three tiles in a row that begin well, and then `prepare` breaks something."""
    with Array(FIRMWARE_ELF, 3, links) as array:
        for tile in array:
            tile.write_eeprom(0, settings_block(tile.index + 1, 20, 0))
        fleet = Fleet()
        reporter = Reporter(fleet, Grid(PLACES))
        readers = [LineReader() for _ in array]
        news: list[News] = []
        for tile in array:
            fleet.take(PortNews(0.0, f"tile-{tile.index + 1:02}", is_open=True))
        prepare(array)
        while array.time_s < seconds:
            go_on(array)
            array.run(STEP_S)
            both = zip(array, readers, strict=True)
            heard = [event for tile, reader in both for event in heard_from(tile, reader)]
            for event in sorted(heard, key=lambda one: one.time_s):
                fleet.take(event)
                news += [told for told in reporter.take(event) if told.bad]
    return news


def test_tiles_in_order_give_no_hint() -> None:
    assert watched(lambda array: None) == []


def test_a_neighbour_without_power_is_named() -> None:
    def pull_power(array: Array) -> None:
        array[2].powered = False

    [news] = watched(pull_power)
    assert (news.tile, news.text.partition(",")[0]) == (
        2,
        "side E: the line stays low: its neighbour has no power",
    )


def test_a_tile_turned_by_90_degrees_is_named_and_so_are_those_beside_it() -> None:
    """Its lines meet lines of the same direction, so no cable joins it to anybody."""
    news = watched(lambda array: None, links=[(0, EAST, 1, WEST)])
    said = {one.tile: one.text for one in news}
    assert set(said) == {2, 3}
    assert "W: its lines are high, and no side hears anybody: the tile is turned by 90 degrees" in said[3]
    assert "E: the line is high and silent: the plug is not in" in said[2]


def test_a_plug_that_is_half_in_is_named() -> None:
    """Without ground its line follows whatever hums nearby."""
    humming: list[Vandal] = []

    def plug_half_in(array: Array) -> None:
        humming.append(Vandal(array[2], EAST, noise(20_000, seed=1, start_s=1.0)))

    def go_on(array: Array) -> None:
        humming[0].play(array.time_s, array.time_s + STEP_S)

    first, news = watched(plug_half_in, go_on=go_on)
    assert (
        first.text
        == "on E is a tile, but no frame of it arrives whole: check the plug, and that both run one model"
    )
    assert first.tile == news.tile == 3
    assert news.text.startswith("side E: bytes come without a stop bit: push the plug in")


def test_a_low_supply_is_told_once_with_what_to_do() -> None:
    [news] = watched(lambda array: array[1].set_supply(4.3))
    assert news.tile == 2
    assert news.text.startswith("SUPPLY 4")
    assert news.text.endswith(f"mV: {SUPPLY_REMEDY}")


@pytest.mark.parametrize(
    ("low_ms", "errors", "words"),
    [(0, 0, {}), (300, 2, {}), (900, 0, {"N": "low"}), (0, 3, {"N": "no stop bits"})],
)
def test_a_hint_needs_more_than_a_plug_that_goes_in(low_ms: int, errors: int, words: dict[str, str]) -> None:
    before = BoardSentence(1, 1000, 5000, (5, 0, 0, 0), (100, 0, 0, 0))
    now = BoardSentence(1, 2000, 5000, (5 + errors, 0, 0, 0), (100 + low_ms, 0, 0, 0))
    assert {side: hint.word for side, hint in line_hints(now, before).items()} == words
