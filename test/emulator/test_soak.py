"""The links at their fastest: nothing is lost, whatever the clocks and phases."""

from pathlib import Path

import pytest

from bench import soak
from firmware import cost_fit


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return cost_fit.build(soak.small_model(), tmp_path_factory.mktemp("small"))


@pytest.mark.soak
def test_of_a_hundred_thousand_frames_not_one_is_damaged(small: Path) -> None:
    soaked = soak.soak(small, soak.PERIOD_MS, 18.0)
    assert soaked.restarts == 0
    assert soaked.all.received > 100_000
    assert soaked.to_software.received + soaked.from_software.received > 50_000
    assert (soaked.all.corrupt, soaked.all.lost) == (0, 0)
    assert soaked.awake > 0.7  # the tiles did have something else to do
