"""Runs of emulated tiles are done again by the simulator; wrong times show."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench import gap
from bench.pairs import EmulatedTiles, Pairs, drawings_of, emulate, period_of, simulate
from tilenca.base import paths
from tilenca.emulator.greeting import firmware_settings
from tilenca.model.file import load_model
from tilenca.simulator.tile_times import TileTimes, tile_times
from tilenca.sweep.emulated import Image

RUNS, SEED = 10, 20


@pytest.fixture(scope="module")
def image(firmware: Path) -> Image:
    folder = paths.DEFAULT_MODEL
    return Image(firmware, firmware_settings(firmware), load_model(folder), folder)


@pytest.fixture(scope="module")
def tiles(image: Image) -> list[EmulatedTiles]:
    return emulate(image, drawings_of(image), RUNS, SEED)


def pairs(image: Image, tiles: list[EmulatedTiles], times: TileTimes) -> Pairs:
    found = simulate(image.model, drawings_of(image), tiles, times, period_of(image))
    return Pairs(np.array([run.converged_at for run in tiles]), found)


def times_of(image: Image) -> TileTimes:
    return tile_times(image.model.dimensions, period_of(image))


def test_a_seed_decides_everything(image: Image, tiles: list[EmulatedTiles]) -> None:
    assert emulate(image, drawings_of(image), 3, SEED) == tiles[:3]
    (other,) = emulate(image, drawings_of(image), 1, SEED + 1)
    assert other.ppm != tiles[0].ppm
    first, second = (pairs(image, tiles, times_of(image)) for _ in range(2))
    assert list(first.simulator) == list(second.simulator)


def test_tiles_and_simulator_are_as_far_apart_as_ten_runs_can_tell(
    image: Image, tiles: list[EmulatedTiles]
) -> None:
    assert [run.drawing for run in tiles] == list(range(RUNS))
    found = pairs(image, tiles, times_of(image))
    assert np.isfinite(found.tiles).all()
    for update in gap.UPDATES:
        difference, half = found.gap(update)
        assert abs(difference) <= half
    assert found.same >= 0.4
    assert found.near >= 0.7


def test_messages_half_a_period_too_early_are_found_out(image: Image, tiles: list[EmulatedTiles]) -> None:
    times = times_of(image)
    right = pairs(image, tiles, times)
    wrong = pairs(image, tiles, replace(times, computing=tuple(part - 0.5 for part in times.computing)))
    assert wrong.same < right.same
    assert wrong.near < right.near
    assert np.mean(wrong.tiles - wrong.simulator) > 1 > abs(np.mean(right.tiles - right.simulator))


def test_pairs_are_compared_one_by_one() -> None:
    tiles, simulator = [5.0, 6.0, 9.0, math.inf], [5.0, 7.0, 6.0, math.inf]
    found = Pairs(np.tile(tiles, 100), np.tile(simulator, 100))
    assert (found.same, found.near) == (0.5, 0.75)
    assert found.gap(5) == (0.0, 3 / 400), "no pair differs"
    assert found.gap(6) == pytest.approx((0.0, 1.96 * 0.5**0.5 / 20)), "as many differ either way"
    assert found.gap(8) == pytest.approx((-0.25, 1.96 * 0.1875**0.5 / 20))


def test_design_has_the_rows_of_each_model() -> None:
    page = (paths.ROOT / "docs" / "DESIGN.md").read_text(encoding="utf-8")
    section = page.partition(gap.BEGIN)[2].partition(gap.END)[0]
    assert [name for name in gap.MODELS if f"| `{name}`, " not in section] == []
    assert section.count("| gap, points |") == len(gap.MODELS)
    widths = {line.count("|") for line in section.splitlines() if line.startswith("|")}
    assert widths == {len(gap.UPDATES) + 4}


def test_runs_are_one_number_or_one_for_each_model(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["gap", "--runs", "1", "2", "3"])
    with pytest.raises(SystemExit):
        gap.main()
    assert "one number, or one for each of 2 models" in capsys.readouterr().err
