"""What a recipe says is explained, and decides what is measured."""

from dataclasses import fields

from tilenca.training.recipe import Recipe, aims_of
from tilenca.training.recipes import RECIPES


def test_every_setting_is_explained() -> None:
    explained = (Recipe.__doc__ or "").replace(",", " ").replace(":", " ").split()
    assert [field.name for field in fields(Recipe) if field.name not in explained] == []


def test_aims_are_what_the_recipe_shows_in_training() -> None:
    full, paper = aims_of(RECIPES["full"]), aims_of(RECIPES["paper"])
    assert (full.stretch, full.damaged, full.unknown) == (RECIPES["full"].stretch, True, True)
    assert (paper.stretch, paper.damaged, paper.unknown) == (1.0, False, False)


def test_one_answer_on_any_drawing_takes_drawings_beside_those_of_the_classes() -> None:
    trained = {name for name, recipe in RECIPES.items() if aims_of(recipe).agreeing}
    assert trained == {"full", "forms", "refine", "many", "damage", "smoke"}
