"""Trainings over each other."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from tilenca.base.errors import UsageError
from tilenca.views import plots


def test_each_training_has_its_own_line_which_a_later_one_does_not_hide(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(plots, "save", lambda figure, path: drawn.append(figure))
    rows: plots.Rows = [(n, 1.0 / n, None if n == 2 else 0.5) for n in range(1, 5)]
    plots.plot_runs({"one": rows, "two": rows, "nothing yet": []}, Path("unused.png"))
    loss, samples = (axes.get_lines() for axes in drawn[0].axes)
    assert [line.get_label() for line in samples] == ["one", "two"]
    assert [np.asarray(line.get_xdata()).tolist() for line in samples] == [[1, 3, 4], [1, 3, 4]]
    assert len({(line.get_color(), line.get_linestyle()) for line in samples}) == 2
    assert loss[0].get_linewidth() > loss[1].get_linewidth()


def test_trainings_without_a_history_cannot_be_drawn(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no training there has a history"):
        plots.plot_runs({"nothing yet": []}, tmp_path / "h.png")
