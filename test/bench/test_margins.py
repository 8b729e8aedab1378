"""Link margins: what two resonators may be apart costs no frame, more does, and the page has every row."""

from pathlib import Path

import pytest

from bench.margins import BEGIN, DIFFERENCES, END, PARTS, Case, Count, Distortion, margin, run
from bench.publish import stands
from tilenca.base.paths import ROOT

SECONDS = 2.0


@pytest.mark.parametrize("difference", [1.6, -1.6])
def test_two_resonators_at_their_worst_lose_no_frame(difference: float) -> None:
    losses = run(Case(difference, busy=True, seconds=SECONDS))
    assert [count.lost for count in losses.counts] == [0, 0, 0]
    assert min(count.arrived for count in losses.counts) > 30


def test_edges_that_a_program_carries_arrive_as_over_a_cable_and_late_ones_do_not() -> None:
    untouched = run(Case(1.0, busy=True, distortion=Distortion(), seconds=SECONDS))
    assert [count.lost for count in untouched.counts] == [0, 0, 0]
    late = run(Case(1.0, busy=True, distortion=Distortion(jitter=0.3), seconds=SECONDS))
    assert min(count.lost for count in late.counts) > 30, "a link that falls silent counts as lost"


def test_the_margin_ends_at_the_first_loss() -> None:
    rows = [(0.0, Count(0, 9)), (1.0, Count(0, 9)), (2.0, Count(1, 8)), (3.0, Count(0, 9))]
    assert margin(rows) == "1"
    assert margin([(0.0, Count(0, 9)), (1.0, Count(0, 0))]) == "0", "nothing arrived"


def test_the_page_has_a_row_for_each_case() -> None:
    page = (ROOT / "docs" / "HARDWARE.md").read_text(encoding="utf-8")
    section = page.partition(BEGIN)[2].partition(END)[0]
    rows = [line for line in section.splitlines() if line.startswith("| ") and " of " in line]
    assert len(rows) == 2 * len(DIFFERENCES) + 3 * len(PARTS)
    assert "With all sides busy nothing was lost up to" in section


def test_a_page_that_has_other_numbers_does_not_stand(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "page.md"
    page.write_text("before\n\n<a>\n\n| 1 |\n\n</a>\n\nafter\n")
    assert stands("| 1 |", page, "<a>", "</a>")
    assert not stands("| 2 |", page, "<a>", "</a>")
    assert "differs" in capsys.readouterr().out
