"""Pictures of a sweep."""

from pathlib import Path
from typing import Any

import pytest

from tilenca.base.errors import UsageError
from tilenca.views.sweep import draw_sweep


def rows(**axes: list[Any]) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = [{}]
    for name, values in axes.items():
        found = [row | {name: value} for row in found for value in values]
    return [
        row | {"share": 0.5, "low": 0.4, "high": 0.6, "median": None if number % 3 == 0 else 9.0}
        for number, row in enumerate(found)
    ]


def test_one_axis_is_a_curve_and_two_of_numbers_a_heat_map_too(tmp_path: Path) -> None:
    one = draw_sweep(rows(loss=[0.0, 0.5]), ["loss"], tmp_path)
    assert [path.name for path in one] == ["curves.svg", "times.svg"]
    two = draw_sweep(
        rows(loss=[0.0, 0.5], boot_spread=[0.2, 1.0], size=["5x4", "7x6"]),
        ["loss", "boot-spread", "size"],
        tmp_path,
    )
    assert [path.name for path in two] == ["curves.svg", "times.svg", "heat.svg"]


def test_the_same_rows_are_the_same_bytes(tmp_path: Path) -> None:
    table = rows(loss=[0.0, 0.5], dead=[0.0, 0.1])
    first = [path.read_bytes() for path in draw_sweep(table, ["loss", "dead"], tmp_path)]
    assert first == [path.read_bytes() for path in draw_sweep(table, ["loss", "dead"], tmp_path)]


def test_the_last_row_of_a_cell_is_drawn(tmp_path: Path) -> None:
    last = rows(loss=[0.0, 0.5])
    first = [row | {"share": 0.9} for row in last]
    draw_sweep(last, ["loss"], tmp_path)
    alone = (tmp_path / "curves.svg").read_bytes()
    draw_sweep([row for pair in zip(first, last, strict=True) for row in pair], ["loss"], tmp_path)
    assert (tmp_path / "curves.svg").read_bytes() == alone


def test_words_alone_cannot_be_drawn(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="--plot needs an axis with several numbers"):
        draw_sweep(rows(size=["5x4", "7x6"]), ["size"], tmp_path)


def test_too_many_curves_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="at most 12 curves in 12 pictures; give fewer values"):
        draw_sweep(
            rows(loss=[0.0, 0.5], dead=[number / 20 for number in range(13)]), ["loss", "dead"], tmp_path
        )
