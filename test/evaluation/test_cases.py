"""Larger drawings get more steps."""

import pytest

from tilenca.evaluation.cases import steps_for
from tilenca.shapes.sizes import Size


@pytest.mark.parametrize(
    ("size", "steps"),
    [
        ((5, 4), 60),
        ((7, 6), 60),
        ((7, 7), 100),
        ((14, 14), 100),
        ((20, 16), 200),
        ((24, 20), 300),
        ((30, 24), 400),
    ],
)
def test_steps_grow_with_the_area(size: Size, steps: int) -> None:
    assert steps_for(size) == steps
