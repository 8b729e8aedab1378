"""Figures are noted by one benchmark after the other, and read at the end."""

from dataclasses import replace
from pathlib import Path

import pytest

from bench.figures import Figure, exact, note, noted, of_rounds


def test_what_is_noted_is_read_and_the_last_of_a_name_counts(tmp_path: Path) -> None:
    place = tmp_path / "new" / "figures.jsonl"
    assert noted(place) == []
    flash, ratio = exact("flash", 100, "bytes"), of_rounds("ratio", [2.0, 2.2, 2.1], "times")
    note(flash, place=place)
    note(ratio, exact("flash", 90, "bytes"), place=place)
    assert noted(place) == [exact("flash", 90, "bytes"), ratio]


def test_the_noise_is_the_range_of_the_rounds_as_a_share_of_their_median() -> None:
    ratio = of_rounds("ratio", [2.0, 2.2, 2.1], "times")
    assert replace(ratio, noise=0.0) == Figure("ratio", 2.1, "times", 0.0, more_is_better=True)
    assert ratio.noise == pytest.approx(0.2 / 2.1)
    with pytest.raises(ValueError, match="one round tells no noise"):
        of_rounds("ratio", [2.0], "times")
