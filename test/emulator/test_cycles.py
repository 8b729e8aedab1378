"""What `tilenca.model.cost` says of a network before it exists, against what the emulated chip then does."""

from pathlib import Path

import pytest

from firmware import cost_fit
from tilenca.base import paths
from tilenca.emulator import Array
from tilenca.emulator.wiring import cables
from tilenca.model import cost
from tilenca.model.file import Dimensions, load_model
from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.sentences import LinkSentence, TileSentence
from tilenca.protocol.settings import settings_block

TOLERANCE = 0.03
RENEW = "run tools/firmware/cost_fit.py and put what it prints into host/tilenca/model/cost.py"


UNEQUAL = Dimensions(28, 56, 34)


@pytest.fixture(scope="module", params=[False, True], ids=["dense", "half of it zero"])
def unequal(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[cost_fit.Probe, Path]:
    """An image with widths that the constants were not fitted to."""
    probe = cost_fit.Probe.of(UNEQUAL, half=request.param)
    return probe, cost_fit.build(probe.model(), tmp_path_factory.mktemp("unequal"))


@pytest.mark.parametrize("period_ms", [100, 250])
def test_other_widths_are_awake_as_long_as_predicted(
    unequal: tuple[cost_fit.Probe, Path], period_ms: int
) -> None:
    probe, elf = unequal
    predicted = cost.update_cycles(probe.size, probe.shares) + cost.CYCLES_PER_MS * period_ms
    measured = cost_fit.awake(elf, period_ms)
    assert abs(predicted / measured - 1) < TOLERANCE, (
        f"predicted {predicted:,.0f}, is {measured:,.0f}; {RENEW}"
    )


@pytest.mark.parametrize("period_ms", [100, 250])
def test_the_shipped_firmware_is_not_awake_for_longer_than_predicted(period_ms: int) -> None:
    """How many of its inputs are zero depends on what it sees; not many fewer than assumed."""
    predicted = cost.estimate(load_model(paths.DEFAULT_MODEL).dimensions, 10, period_ms).awake_cycles
    measured = cost_fit.awake(paths.FIRMWARE_ELF, period_ms)
    assert 0.85 < measured / predicted < 1 + TOLERANCE, (
        f"predicted {predicted:,.0f}, is {measured:,.0f}; {RENEW}"
    )


def test_at_the_shortest_period_tiles_keep_up_and_lose_nothing(unequal: tuple[cost_fit.Probe, Path]) -> None:
    """Also where nothing is zero, which the period does not allow for in full."""
    probe, elf = unequal
    period_ms = cost.shortest_period_ms(probe.size)
    count = len(cost_fit.CROSS.cells)
    with Array(
        elf, count, cables(cost_fit.CROSS), [900.0, -900, 0, 500, -500], [0, 0.031, 0.012, 0.005, 0.017]
    ) as array:
        for tile in array:
            tile.write_eeprom(0, settings_block(tile.index + 1, period_ms, 0))
        array.run(1.0)
        reader = LineReader()
        reader.feed(array[cost_fit.MIDDLE].read_serial())
        array.run(6.0)
        said = [sentence for _, sentence in reader.feed(array[cost_fit.MIDDLE].read_serial())]
    tiles = [sentence for sentence in said if isinstance(sentence, TileSentence)]
    passed_ms = tiles[-1].uptime_ms - tiles[0].uptime_ms
    assert tiles[-1].updates - tiles[0].updates == pytest.approx(passed_ms / period_ms, abs=1)
    links = [sentence for sentence in said if isinstance(sentence, LinkSentence)]
    last = {link.side: link for link in links}
    first = {link.side: link for link in reversed(links)}
    assert len(last) == 4
    for side, link in last.items():
        assert link.received - first[side].received > 50
        assert (link.lost, link.corrupt) == (first[side].lost, first[side].corrupt)
