"""A mistyped word brings the one that was meant."""

from pathlib import Path

import pytest

from tilenca.base.errors import UsageError
from tilenca.base.suggest import did_you_mean
from tilenca.shapes.file import load_task
from tilenca.training.recipes import find_recipe


def test_the_closest_word_is_offered_and_none_where_nothing_is_close() -> None:
    assert did_you_mean("thicknes", ["slant", "thickness"]) == " (did you mean 'thickness'?)"
    assert did_you_mean("paper", ["slant", "thickness"]) == ""
    assert did_you_mean("l", ["t", "L"]) == " (did you mean 'L'?)"


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("[vary]\nslnat = 0.1\n", "slant"),
        ("[sizes]\nheld_ou = []\n", "held_out"),
        ("[varry]\nslant = 0.1\n", "vary"),
    ],
)
def test_a_mistyped_key_of_a_shape_file_is_told_with_the_right_one(
    text: str, meant: str, tmp_path: Path
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(text + '[[shape]]\nlabel = "1"\ngrid = """\n#\n#\n"""\n')
    with pytest.raises(UsageError, match=f"did you mean '{meant}'"):
        load_task(path)


def test_a_mistyped_recipe_is_told_with_the_right_one() -> None:
    with pytest.raises(UsageError, match=r"no recipe 'quik' .did you mean 'quick'"):
        find_recipe("quik")
