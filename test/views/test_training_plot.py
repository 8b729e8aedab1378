"""The picture of a training."""

import math
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from tilenca.base.errors import UsageError
from tilenca.views import training_plot
from tilenca.views.abilities import Targets
from tilenca.views.training_plot import HELD, HISTORY, MISSED, plot_history

ROWS = [(50 * n, 1 / n, 1 - 1 / n) for n in range(1, 101)]


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """The figures that would have been saved."""
    drawn: list[Figure] = []
    monkeypatch.setattr(training_plot, "save", lambda figure, path: drawn.append(figure))
    return drawn


def panel(figure: Figure, title: str) -> Axes:
    return next(axes for axes in figure.axes if axes.get_title("left").startswith(title))


def points(axes: Axes, marker: str) -> list[tuple[float, float, object, object]]:
    """Where the points of a panel are, their colours and what fills them."""
    return [
        (*line.get_xydata()[0], line.get_color(), line.get_markerfacecolor())  # type: ignore[index, misc]
        for line in axes.get_lines()
        if line.get_marker() == marker
    ]


def test_every_measured_column_has_a_panel_of_its_own_where_it_was_measured(figures: list[Figure]) -> None:
    columns = (*HISTORY, "@1000", "@60", "seconds", "@sizes")
    rows = [(*row, 0.25, 0.5 if n % 20 == 0 else None, 3.0, 1.0) for n, row in enumerate(ROWS)]
    plot_history(rows, Path("unused.png"), columns)
    loss, samples, *kinds = figures[0].axes
    assert loss.get_yscale() == "log"
    assert samples.get_ylabel() == "training\nsamples right"
    assert [axes.get_title("left") for axes in kinds] == [
        "sizes: know other sizes",
        "measured after 60 steps",
        "measured after 1000 steps",
    ]
    line = kinds[1].get_lines()[0]
    assert np.asarray(line.get_xydata()).tolist() == [[50 + 1000 * n, 0.5] for n in range(5)]
    assert {axes.get_title("right") for axes in kinds} == {"no target"}


def test_held_and_missed_differ_in_colour_and_shape_with_the_target_as_a_line(figures: list[Figure]) -> None:
    columns = (*HISTORY, "@lost", "@changes")
    rows = [(10, 1.0, 0.0, 0.5, 0.9), (20, 0.5, 0.5, 0.99, 0.99)]
    targets = {"lost": Targets(2, 2, 0.95, 0.97), "changes": Targets(1, 3, 0.95, 0.8)}
    plot_history(rows, Path("unused.png"), columns, targets=targets)
    lost, changes = panel(figures[0], "lost"), panel(figures[0], "changes")
    assert points(lost, "o") == [(10, 0.5, MISSED, "white"), (20, 0.99, HELD, HELD)]
    assert points(lost, "D") == [(20, 0.97, HELD, HELD)]
    assert points(changes, "D") == [(20, 0.8, MISSED, "white")]
    for axes in (lost, changes):
        dashes = [line for line in axes.get_lines() if line.get_linestyle() == "--"]
        assert [set(np.asarray(line.get_ydata()).tolist()) for line in dashes] == [{0.95}]
    assert lost.get_title("right") == "2 of 2 targets held"
    assert changes.get_title("right") == "1 of 3 targets held, 2 missed"


def test_kinds_stand_in_one_order_also_those_that_only_the_finished_model_was_asked(
    figures: list[Figure],
) -> None:
    targets = {"dead": Targets(0, 1, 0.1, 0.05), "drawings": Targets(1, 1, 0.9, 1.0)}
    columns = (*HISTORY, "@longevity", "@sizes", "@drawings (all rows)")
    plot_history([(*row, 1.0, 1.0, 0.5) for row in ROWS], Path("unused.png"), columns, targets=targets)
    titles = [axes.get_title("left").split(":")[0] for axes in figures[0].axes[2:]]
    assert titles == ["drawings", "drawings (all rows)", "sizes", "dead", "longevity"]


def test_the_mean_line_begins_and_ends_near_its_points(figures: list[Figure]) -> None:
    plot_history([(n, 100.0 - n, n / 100) for n in range(1, 100)], Path("unused.png"))
    raw, mean = figures[0].axes[0].get_lines()
    assert list(np.asarray(raw.get_ydata())) == [100.0 - n for n in range(1, 100)]
    np.testing.assert_allclose(np.asarray(mean.get_ydata()), np.asarray(raw.get_ydata()), atol=2)


@pytest.mark.parametrize("rows", [ROWS[:1], [(1, 0.0, 0.0), (2, 0.0, 1.0)], [(1, math.nan, 0.5)]])
def test_short_histories_and_losses_of_nothing(rows: list[tuple[float, ...]], tmp_path: Path) -> None:
    plot_history(rows, tmp_path / "h.png")
    with Image.open(tmp_path / "h.png") as image:
        image.load()


def test_histories_that_cannot_be_drawn(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no rows"):
        plot_history([], tmp_path / "h.png")
    with pytest.raises(UsageError, match="no column 'loss'"):
        plot_history([(1, 2)], tmp_path / "h.png", ("iteration", "agreement"))
    with pytest.raises(UsageError, match=r"written as \.png or \.svg"):
        plot_history(ROWS, tmp_path / "h.bmp")
    assert list(tmp_path.iterdir()) == []
