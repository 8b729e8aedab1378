"""Named recipes: every one can be trained with, and unknown ones are refused."""

from dataclasses import fields

import pytest

from tilenca.base.errors import UsageError
from tilenca.training.recipes import RECIPES, Recipe, aims_of, find_recipe, trains_for

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


def test_every_setting_is_explained() -> None:
    explained = (Recipe.__doc__ or "").replace(",", " ").replace(":", " ").split()
    assert [field.name for field in fields(Recipe) if field.name not in explained] == []


def test_an_unknown_recipe_lists_the_known_ones() -> None:
    with pytest.raises(UsageError, match=f"no recipe 'fast'; there are: {' '.join(RECIPES)}"):
        find_recipe("fast")


def test_aims_are_what_the_recipe_shows_in_training() -> None:
    full, paper = aims_of(RECIPES["full"]), aims_of(RECIPES["paper"])
    assert (full.stretch, full.damaged, full.unknown) == (RECIPES["full"].stretch, True, True)
    assert (paper.stretch, paper.damaged, paper.unknown) == (1.0, False, False)


def test_one_answer_on_any_drawing_takes_drawings_beside_those_of_the_classes() -> None:
    trained = {name for name, recipe in RECIPES.items() if trains_for(recipe, "one answer")}
    assert trained == {"full", "forms", "refine", "many", "damage", "smoke"}
    assert all(trains_for(recipe, "drawings") for recipe in RECIPES.values())
