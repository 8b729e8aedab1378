"""The picture of a training."""

import math
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from tilenca.base.errors import UsageError
from tilenca.views import plots

ROWS = [(50 * n, 1 / n, 1 - 1 / n) for n in range(1, 101)]


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """The figures that would have been saved."""
    drawn: list[Figure] = []
    monkeypatch.setattr(plots, "save", lambda figure, path: drawn.append(figure))
    return drawn


def test_all_validation_columns_are_drawn_where_they_were_measured(figures: list[Figure]) -> None:
    columns = (*plots.HISTORY, "@60", "seconds", "@1000")
    rows = [(*row, 0.5 if n % 20 == 0 else None, 3.0, 0.25) for n, row in enumerate(ROWS)]
    plots.plot_history(rows, Path("unused.png"), columns)
    upper, lower = figures[0].axes
    assert upper.get_yscale() == "log"
    legend = lower.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == [
        "training samples",
        "measured after 60 steps",
        "measured after 1000 steps",
    ]
    lines = {line.get_label(): line for line in lower.get_lines()}
    measured = lines["measured after 60 steps"]
    assert list(np.asarray(measured.get_xdata())) == [50, 1050, 2050, 3050, 4050]
    assert set(np.asarray(measured.get_ydata())) == {0.5}


def test_a_kind_of_measurement_looks_the_same_in_every_picture_and_no_line_hides_another(
    figures: list[Figure],
) -> None:
    some = (*plots.HISTORY, "@sizes", "@drawings")
    more = (*plots.HISTORY, "@longevity", "@drawings", "@lost", "@sizes", "@changes")
    for columns in (some, more):
        rows = [(*row, *[1.0] * (len(columns) - 3)) for row in ROWS]
        plots.plot_history(rows, Path("unused.png"), columns)
    first, second = (
        {
            str(line.get_label()): (line.get_color(), line.get_linestyle(), line.get_linewidth())
            for line in figure.axes[1].get_lines()
            if not str(line.get_label()).startswith("_")
        }
        for figure in figures
    )
    assert first.items() <= second.items()
    assert len(set(second.values())) == len(second) == 6
    widths = [look[2] for label, look in second.items() if label != "training samples"]
    assert widths == sorted(set(widths), reverse=True), "each is drawn upon a wider one"


def test_the_mean_line_begins_and_ends_near_its_points(figures: list[Figure]) -> None:
    plots.plot_history([(n, 100.0 - n, n / 100) for n in range(1, 100)], Path("unused.png"))
    raw, mean = figures[0].axes[0].get_lines()
    assert list(np.asarray(raw.get_ydata())) == [100.0 - n for n in range(1, 100)]
    np.testing.assert_allclose(np.asarray(mean.get_ydata()), np.asarray(raw.get_ydata()), atol=2)


@pytest.mark.parametrize("rows", [ROWS[:1], [(1, 0.0, 0.0), (2, 0.0, 1.0)], [(1, math.nan, 0.5)]])
def test_short_histories_and_losses_of_nothing(rows: list[tuple[float, ...]], tmp_path: Path) -> None:
    plots.plot_history(rows, tmp_path / "h.png")
    with Image.open(tmp_path / "h.png") as image:
        image.load()


def test_histories_that_cannot_be_drawn(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no rows"):
        plots.plot_history([], tmp_path / "h.png")
    with pytest.raises(UsageError, match="no column 'loss'"):
        plots.plot_history([(1, 2)], tmp_path / "h.png", ("iteration", "agreement"))
    with pytest.raises(UsageError, match=r"written as \.png or \.svg"):
        plots.plot_history(ROWS, tmp_path / "h.bmp")
    assert list(tmp_path.iterdir()) == []
