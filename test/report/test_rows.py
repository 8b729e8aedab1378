"""Rows are read from what the commands print, and each has the command that repeats it."""

import json
import shlex
from typing import Any

import pytest

from tilenca import cli
from tilenca.report.rows import (
    SECONDS,
    SHARE,
    STEPS,
    read_curve,
    read_emulations,
    read_evaluation,
    read_suite,
    seed_of,
    slug,
)


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    assert cli.main([*words, "--json"]) == 0
    result: dict[str, Any] = json.loads(capsys.readouterr().out)
    return result


def test_an_evaluation_has_a_share_with_an_interval_and_a_time(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("evaluate", "--steps", "60", "--runs", "3", "--seed", "7")
    right, time = read_evaluation("paper.x", "ten digits", printed(capsys, *words), words)
    assert (right.key, right.unit, right.runs, right.seed) == ("paper.x.right", SHARE, 30, 7)
    assert right.low is not None
    assert right.value is not None
    assert right.low < right.value
    assert (time.unit, time.low) == (STEPS, None)
    assert shlex.split(right.command) == ["tilenca", *words]


def test_a_row_of_the_suite_repeats_by_its_own_command(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("evaluate", "--suite", "--runs", "2", "--seed", "7")
    rows = read_suite("suite", "", printed(capsys, *words, "--row", "listing", "--row", "12x10, any"), words)
    assert len(rows) == 7
    assert len({row.key for row in rows}) == 7
    last = rows[-1]
    _, *again = shlex.split(last.command)
    (same,) = read_suite("suite", "", printed(capsys, *again), words)
    assert same == last


def test_a_curve_has_a_row_for_every_update(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("simulate", "--shape", "4", "--steps", "6", "--runs", "2", "--seed", "3")
    rows = read_curve("paper.curve.4", "'4', the paper's listing", printed(capsys, *words), words)
    assert [row.across for row in rows] == [1, 2, 3, 4, 5, 6]
    assert {row.line for row in rows} == {"'4'"}
    assert all(row.value is not None and 0 <= row.value <= 1 for row in rows)


def test_seeds_and_keys_are_read_from_words() -> None:
    assert seed_of(["emulate", "--seed", "12", "--json"]) == 12
    assert slug("20 % of the messages lost, read as zero") == "20-of-the-messages-lost-read-as-zero"


@pytest.mark.usefixtures("firmware")
@pytest.mark.parametrize("shapes", [("7",), ("7", "1")])
def test_an_emulation_has_a_share_and_two_times(
    shapes: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("emulate", *(word for shape in shapes for word in ("--shape", shape)), "--seed", "4")
    right, powered, updated = read_emulations("paper.tiles", "digits", printed(capsys, *words), words)
    assert (right.value, right.runs, right.unit) == (1.0, len(shapes), SHARE)
    assert powered.unit == updated.unit == SECONDS
    assert powered.value is not None
    assert updated.value is not None
    assert powered.value > updated.value
