"""The picture of the tiles: what is drawn, in which characters and colours."""

import io
from pathlib import Path

import pytest
from rich.console import Console

from tilenca.base import paths
from tilenca.shapes.file import Shape, load_task
from tilenca.shapes.glyphs import GLYPHS
from tilenca.views.tiles import Picture, beside, digit, fitting

SHAPE = Shape("L", ("#.", "##"), "L")
LIT = Picture(SHAPE, (GLYPHS["L"], GLYPHS["8"], 0), ((0, 0, 30), (20, 20, 20), (0, 0, 0)))


def shown(
    *pictures: Picture,
    width: int = 80,
    height: int | None = None,
    encoding: str = "utf-8",
    colour: bool = False,
) -> str:
    """What a console of that kind is sent."""
    file = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    console = Console(
        file=file, width=width, force_terminal=colour, color_system="truecolor" if colour else None
    )
    console.print(beside(pictures, console, width, height))
    file.seek(0)
    return file.read()


def test_digits_are_drawn_in_lines_that_meet() -> None:
    assert digit(GLYPHS["8"]) == ("┏━┓", "┣━┫", "┗━┛")
    assert digit(GLYPHS["4"]) == ("╻ ╻", "┗━┫", "  ╹")
    assert digit(GLYPHS["-"]) == ("   ", "╺━╸", "   ")
    assert digit(0) == ("   ", "   ", "   ")


def test_no_two_glyphs_look_the_same() -> None:
    pictures = {digit(segments) for segments in GLYPHS.values()}
    assert len(pictures) == len(set(GLYPHS.values()))


def test_touching_tiles_share_a_frame_and_dark_ones_have_one() -> None:
    assert (
        shown(LIT)
        == """\
╭─────╮
│ ╻   │
│ ┃   │
│ ┗━╸ │
├─────┼─────╮
│ ┏━┓ │     │
│ ┣━┫ │     │
│ ┗━┛ │     │
╰─────┴─────╯

"""
    )


@pytest.mark.parametrize("small", [{"height": 9}, {"encoding": "ascii"}])
def test_where_frames_do_not_fit_it_is_ascii(small: dict[str, object]) -> None:
    text = shown(LIT, **small)  # type: ignore[arg-type]
    assert text.isascii()
    assert text.splitlines()[:6] == ["", "|", "|_", " _", "|_|  .", "|_|"]


def test_shapes_are_side_by_side_as_many_as_fit() -> None:
    lines = shown(LIT, LIT, LIT, width=28).splitlines()
    assert max(map(len, lines)) == 28
    assert len(lines) == 2 * (9 + 1)
    assert len(shown(LIT, LIT, LIT, width=27).splitlines()) == 3 * (9 + 1)


def test_every_shipped_shape_has_as_many_frames_as_tiles() -> None:
    for path in Path(paths.SHAPES).glob("*.toml"):
        for shape in load_task(path).shapes:
            count = len(shape.cells)
            text = shown(Picture(shape, (GLYPHS["-"],) * count, ((0, 20, 0),) * count), width=200)
            assert text.count("│ ╺━╸ ") == count


def test_colours_are_the_leds_and_only_where_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert "38;2;76;76;240;48;2;28;28;28m ┗━╸ " in shown(LIT, colour=True)
    assert "\x1b" not in shown(LIT)
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in shown(LIT, colour=True)


def plain(picture: Picture, width: int, height: int, ascii_only: bool = False) -> list[str]:
    return [line.plain.rstrip() for line in fitting(picture, width, height, ascii_only)]


def test_the_largest_picture_that_fits_is_taken() -> None:
    assert plain(LIT, 80, 24)[0] == "╭─────╮"
    assert plain(LIT, 80, 8) == ["L", "8 ·"]
    assert plain(LIT, 12, 24) == ["L", "8 ·"]
    assert plain(LIT, 80, 1) == ["▀▄"], "two rows of tiles in a line"
    assert plain(LIT, 80, 6, ascii_only=True)[0].strip() != "L"
    assert plain(LIT, 80, 5, ascii_only=True) == ["L", "8 ."]


def test_the_tallest_shapes_with_ids_fit_a_usual_terminal() -> None:
    block = Shape("8", ("#" * 6,) * 42, "8")
    picture = Picture(block, (GLYPHS["8"],) * 252, ((20, 20, 20),) * 252)
    lines = plain(picture, 80, 21)
    assert lines == ["▀" * 6] * 21


def test_labels_that_the_model_has_come_before_others_that_look_the_same() -> None:
    picture = Picture(Shape("S", ("#",), "S"), (GLYPHS["S"],), ((0, 0, 30),))
    assert fitting(picture, 80, 2, False, ("S",))[0].plain == "S "
    assert fitting(picture, 80, 2, False, ())[0].plain == "5 "
