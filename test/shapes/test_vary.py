"""The tables [vary] and [forms] of a shape file."""

from pathlib import Path

import pytest

from tilenca.base.errors import UsageError
from tilenca.shapes.file import load_task
from tilenca.shapes.sizes import Sizes
from tilenca.shapes.vary import Vary

SHAPE = '\n[[shape]]\nlabel = "L"\ngrid = """\n#.\n##\n"""\n'


def read(folder: Path, text: str) -> Vary | None:
    file = folder / "mine.toml"
    file.write_text(text + SHAPE)
    return load_task(file).vary


def test_what_a_file_leaves_out_has_a_default_and_false_means_none(tmp_path: Path) -> None:
    assert read(tmp_path, "") == Vary()
    assert read(tmp_path, "[vary]") == Vary()
    assert read(tmp_path, "vary = false") is None


@pytest.mark.parametrize(
    ("vary", "sizes", "limits"),
    [
        (Vary(), Sizes(), ((4, 3), (9, 7))),
        (Vary(), Sizes(trained=((4, 6), (8, 5))), ((4, 4), (8, 6))),
        (Vary(least=(3, 3), most=(6, 6)), Sizes(trained=((4, 6), (8, 5))), ((3, 3), (6, 6))),
        (Vary(least=(20, 20)), Sizes(), ((20, 20), (20, 20))),
    ],
)
def test_sizes_follow_the_file_unless_they_are_given(
    vary: Vary, sizes: Sizes, limits: tuple[tuple[int, int], tuple[int, int]]
) -> None:
    sized = vary.sized((5, 4), sizes)
    assert (sized.least, sized.most) == limits


def test_every_key_is_read(tmp_path: Path) -> None:
    text = """[vary]
from = "4x3"
to = "9x8"
thickness = [2, 3]
slant = 0.1
turn = 3
bars = 0.2
jitter = 0.3
corners = 0.4
ends = 0.5
hooks = 0.6
feet = 0.7"""
    assert read(tmp_path, text) == Vary((4, 3), (9, 8), (2, 3), 0.1, 3.0, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("vary = true", r"write \[vary\] on a line"),
        ("[vary]\nwobble = 1", r"\[vary\] has no 'wobble'; it has from, to, thickness"),
        ("[vary]\nslant = 2", "slant 2; give a number from 0 to 1"),
        ("[vary]\nslant = true", "slant True; give a number"),
        ('[vary]\nslant = "much"', "slant 'much'; give a number"),
        ("[vary]\nthickness = 0", "thickness 0; write the least and the most"),
        ("[vary]\nthickness = [3, 1]", r"thickness \[3, 1\]; write"),
        ('[vary]\nthickness = 9\nto = "4x4"', "thickness 9 leaves no room in 4x4"),
        ("[vary]\nthickness = [1, 2, 3]", "write the least and the most"),
        ('[vary]\nfrom = "5"', r"\[vary\] from: '5' is not a size"),
        ('[vary]\nfrom = "9x9"\nto = "8x9"', "from 9x9 is larger than to 8x9"),
        ("forms = 1", r"write \[forms\] on a line"),
        ('[forms]\n"7" = ["0,0 1,0"]', r"\[forms\] '7' has no \[\[shape\]\]; the file has: L"),
        ('[forms]\nL = "0,0 1,0"', "must be a list of texts"),
        ('[forms]\nL = ["0,0"]', "needs two points or more"),
        ('[forms]\nL = ["0,0 1;0"]', "'1;0' is not a point like 0,.5"),
        ('[forms]\nL = ["0,0 2,0"]', "'2,0' lies outside of the unit square"),
        ('[forms]\nL = ["0,0 nan,0"]', "lies outside"),
        ('[forms]\nL = ["0,0 1,0 | 0,1 1,1"]', "strokes are not connected"),
        ('[forms]\nL = ["0,0 1,0 |"]', "needs two points or more"),
    ],
)
def test_what_is_wrong_is_named_with_its_remedy(tmp_path: Path, text: str, what: str) -> None:
    with pytest.raises(UsageError, match=what) as caught:
        read(tmp_path, text)
    assert "mine.toml" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_forms_are_read_beside_the_drawings(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text('[forms]\nL = ["0,0 0,1 1,1", "0,0 0,1 | 0,1 1,1 1,.8"]\n' + SHAPE)
    forms = load_task(file).forms
    assert [label for label, _ in forms] == ["L", "L"]
    assert [len(skeleton.edges) for _, skeleton in forms] == [2, 3]
