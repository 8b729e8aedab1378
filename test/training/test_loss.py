"""The loss of a few cells, worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from tilenca.shapes.batch import NO_CLASS
from tilenca.training.loss import Goal, agreed_targets, loss_of, scores_of

# Three cells of a hidden channel and two scores: the first is perfect, the second undecided, the third wrong.
END = torch.tensor([[0.5, 1.0, 0.0], [0.0, 0.5, 0.5], [0.0, 1.0, 0.0]])
START = torch.tensor([[0.0, 1.0, 0.0], [0.0, 0.5, 0.5], [0.0, 0.0, 1.0]])
EVERY, NONE = torch.ones(3, dtype=torch.bool), torch.zeros(3, dtype=torch.bool)
GOAL = Goal(2, torch.tensor([0, 0, 1]), EVERY, EVERY)


def test_scores_are_the_last_channels() -> None:
    assert scores_of(END, 2).tolist() == [[1.0, 0.0], [0.5, 0.5], [1.0, 0.0]]


def test_the_loss_is_the_squared_error_of_the_scores_as_a_mean_over_the_cells() -> None:
    assert loss_of(START, END, GOAL, 0.0).item() == pytest.approx((0.0 + 0.5 + 2.0) / 3)


def test_a_limit_bounds_what_one_cell_can_add() -> None:
    limited = loss_of(START, END, GOAL, 0.0, limit=1.0).item()
    assert limited == pytest.approx((0.0 + 0.5 / 1.5 + 2.0 / 3.0) / 3)
    far = END.clone()
    far[2, 1] = 1000.0
    assert loss_of(START, far, GOAL, 0.0, limit=1.0).item() < (0.0 + 0.5 / 1.5 + 1.0) / 3


def test_scores_that_do_not_count_add_nothing() -> None:
    first_two = replace(GOAL, counted=torch.tensor([True, True, False]))
    assert loss_of(START, END, first_two, 0.0).item() == pytest.approx(0.5 / 3)


def test_only_right_cells_of_converged_grids_pay_for_a_change() -> None:
    """The first cell is right and changed by 0.5; the third changed by more, from right to wrong."""
    assert loss_of(START, END, replace(GOAL, counted=NONE), 4.0).item() == pytest.approx(4 * 0.25 / 3)
    assert loss_of(START, END, replace(GOAL, counted=NONE, converged=NONE), 4.0).item() == 0.0


def test_the_gradient_reaches_only_the_end_of_the_rollout() -> None:
    start, end = START.clone(), END.clone().requires_grad_()
    loss_of(start, end, GOAL, 4.0).backward()  # type: ignore[no-untyped-call]
    assert end.grad is not None
    # Of the hidden channel only the stability penalty of the first cell has a gradient: 4 * 2 * 0.5 / 3.
    assert end.grad[:, 0].tolist() == pytest.approx([4 / 3, 0.0, 0.0])


def test_tiles_of_an_unlabelled_grid_are_pulled_to_the_class_that_they_favour_together() -> None:
    scores = torch.tensor([[0.9, 0.2], [0.0, 0.5], [0.1, 0.8], [0.2, 0.3]])
    target = torch.tensor([1, NO_CLASS, NO_CLASS, NO_CLASS])
    starts = np.array([0, 1])
    assert agreed_targets(scores, target, starts).tolist() == [1, 1, 1, 1]
    assert agreed_targets(scores, target[:1].repeat(4), starts).tolist() == [1, 1, 1, 1]
    assert agreed_targets(scores.flip(1), target, starts).tolist() == [1, 0, 0, 0]
