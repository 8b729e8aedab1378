"""Named recipes: every one can be trained with, and unknown ones are refused."""

import pytest

from tilenca.base.errors import UsageError
from tilenca.training.recipes import RECIPES, find_recipe

SHARES = (
    "reset",
    "staggered_start",
    "switch",
    "state_shuffle",
    "away",
    "clocks",
    "lossy",
    "max_loss",
    "stale",
)
PAIRS = ("ticks", "fire_rate", "ticks_per_period", "latency", "undisturbed_ticks", "refresh_steps")


@pytest.mark.parametrize("name", sorted(RECIPES))
def test_every_recipe_is_possible(name: str) -> None:
    recipe = find_recipe(name)
    assert recipe is RECIPES[name]
    assert all(0 <= getattr(recipe, share) <= 1 for share in SHARES)
    assert all(low <= high for low, high in (getattr(recipe, pair) for pair in PAIRS))
    assert recipe.undisturbed_batch <= recipe.batch
    assert recipe.stretched + recipe.damaged + recipe.unknown < 1, "some drawings are as drawn"
    assert recipe.seeds >= 1


def test_an_unknown_recipe_lists_the_known_ones() -> None:
    with pytest.raises(UsageError, match=f"no recipe 'fast'; there are: {' '.join(RECIPES)}"):
        find_recipe("fast")
