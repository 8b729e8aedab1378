"""The loss of a few cells, worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from tilenca.shapes.batch import NO_CLASS
from tilenca.training.loss import BESIDE, GapGoal, Goal, agreed_targets, directions_of, loss_of, scores_of

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


# Four directions come before the two scores: the first cell says west, the second nothing, the third north.
SIDES_SAID = torch.tensor(
    [[0.0, 0.0, 0.0, 0.9, 1.0, 0.0], [0.4, 0.0, 0.0, 0.0, 1.0, 0.0], [0.7, 0.6, 0.0, 0.0, 1.0, 0.0]]
)
WEST, NOWHERE_, EAST = [0.0, 0.0, 0.0, 1.0], [0.0] * 4, [0.0, 1.0, 0.0, 0.0]
GAPS = GapGoal(torch.tensor([WEST, NOWHERE_, EAST]), EVERY, 2.0)


def test_directions_are_the_four_channels_before_the_scores() -> None:
    assert directions_of(SIDES_SAID, 2)[0].tolist() == pytest.approx(WEST, abs=0.11)


def test_the_error_of_the_directions_is_added_where_it_is_told_what_is_missing() -> None:
    goal = Goal(2, torch.tensor([0, 0, 0]), EVERY, NONE, GAPS)
    each = [2 * BESIDE * 0.1**2, 2 * 0.4**2, 2 * BESIDE * (0.7**2 + 0.4**2)]
    assert loss_of(SIDES_SAID, SIDES_SAID, goal, 0.0).item() == pytest.approx(sum(each) / 3)
    some = replace(goal, gaps=replace(GAPS, told=torch.tensor([True, True, False])))
    assert loss_of(SIDES_SAID, SIDES_SAID, some, 0.0).item() == pytest.approx(sum(each[:2]) / 3)


def test_a_cell_is_right_about_its_directions_by_what_a_tile_would_say() -> None:
    assert GAPS.right(directions_of(SIDES_SAID, 2)).tolist() == [True, True, False]
    assert replace(GAPS, told=NONE).right(directions_of(SIDES_SAID, 2)).all()


def test_a_tile_that_says_the_wrong_direction_pays_nothing_for_a_change() -> None:
    """All cells show their class and change by 0.5; the third says the wrong side, and may."""
    start = SIDES_SAID.clone()
    start[:, 4] += 0.5
    goal = Goal(2, torch.tensor([0, 0, 0]), NONE, EVERY, GAPS)
    assert loss_of(start, SIDES_SAID, goal, 4.0).item() == pytest.approx(4 * 2 * 0.25 / 3)
