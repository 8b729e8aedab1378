"""The fault atlas: heat maps, and where each claim ends."""

from dataclasses import replace

import pytest

from tilenca.report.atlas import EXPERIMENTS, endings, heat_maps
from tilenca.report.rows import SHARE, STEPS, Row
from tilenca.report.words import why

ROW = Row("k", "what", 1.0, SHARE, 0.9, 1.0, 10, 1, "tilenca sweep", across=0.0)


def line(*shares: float) -> list[Row]:
    return [replace(ROW, across=number / 10, value=share) for number, share in enumerate(shares)]


@pytest.mark.parametrize(
    ("shares", "said"),
    [
        ((1.0, 0.995, 0.8, 1.0), "5x4: holds up to 0.1, 0.80 at 0.2"),
        ((1.0, 0.99), "5x4: holds up to 0.1, the most that was asked"),
        ((1.0, 0.9), "5x4: holds without any, 0.90 at 0.1"),
        ((0.4, 0.3), "5x4: holds nowhere, 0.40 at 0"),
    ],
)
def test_a_claim_ends_at_the_first_value_at_which_more_than_one_run_in_a_hundred_is_wrong(
    shares: tuple[float, ...], said: str
) -> None:
    assert list(endings({"5x4": line(*shares)})) == [said]


def test_times_and_single_values_have_no_end() -> None:
    times = [replace(row, unit=STEPS) for row in line(7, 9)]
    assert not list(endings({"": times, "one": line(1.0)}))


def test_a_heat_map_has_its_first_axis_to_the_right_and_one_map_for_each_value_of_the_third() -> None:
    rows = [
        replace(ROW, value=loss + dead, place={"loss": f"{loss}", "dead": f"{dead}", "size": size})
        for size in ("5x4", "7x6")
        for loss in (0.1, 0.2)
        for dead in (0.3, 0.4, 0.5)
    ]
    small, large = heat_maps(rows)
    assert (small.title, large.title) == ("size 5x4", "size 7x6")
    assert (small.across, small.down, small.columns) == ("loss", "dead", ("0.1", "0.2"))
    assert [down for down, _ in small.rows] == ["0.3", "0.4", "0.5"]
    assert [[row.value for row in cells] for _, cells in small.rows] == [
        [loss + dead for loss in (0.1, 0.2)] for dead in (0.3, 0.4, 0.5)
    ]
    (only,) = heat_maps([replace(row, place=dict(list(row.place.items())[:2])) for row in rows[:6]])
    assert only.title == ""


def test_every_experiment_of_the_atlas_is_drawn_and_says_why_it_ends() -> None:
    for experiment in EXPERIMENTS:
        assert experiment.figure, experiment.key
        assert len(why(experiment.key)) > 100, experiment.key
