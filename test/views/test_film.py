"""A film's pictures: the tiles, their digits and colours."""

import weakref
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from support.films import change_of, film_of
from tilenca.shapes.glyphs import GLYPHS, look_of, screen_colour
from tilenca.simulator.trace import NOTHING, Film
from tilenca.views import film as pictures
from tilenca.views.reel import Picture, Reel, of_run


@pytest.mark.parametrize("steps", [1, 19, 23, 24, 60, 500])
def test_a_strip_shows_the_first_and_the_last_step_and_no_more_than_fit(steps: int) -> None:
    reel = of_run(film_of("4", steps))
    shown = pictures.panels_of(reel)
    assert shown[0] == 0
    assert shown[-1] == steps
    assert len(shown) <= pictures.MAX_PANELS
    assert shown == sorted(set(shown))
    if steps < pictures.MAX_PANELS:
        assert len(shown) == steps + 1
    else:
        assert reel.agreed_at in shown
        assert set(shown) - {steps} <= set(reel.eventful)


def test_a_strip_shows_when_tiles_agree_for_the_first_time_before_they_are_rebuilt() -> None:
    film = change_of("4", "8", steps=20, between=3)
    shown = pictures.panels_of(of_run(film))
    first = int(np.flatnonzero(film.right)[0])
    assert {first, film.agreed_at} <= set(shown)
    assert len(film.eventful) > pictures.MAX_PANELS >= len(shown)


def test_a_tile_has_the_colour_and_the_segments_of_what_it_shows() -> None:
    film = film_of("1", steps=1)
    shown = np.array([[NOTHING, 2, 8, 4, 7]])
    there = np.ones((1, 5), np.bool_)
    axes = Figure().add_axes((0, 0, 1, 1))
    one = Film("1", film.cells, film.labels, shown, there, film.wanted[:1], "")
    pictures.draw_tiles(axes, of_run(one), 0)
    fills = [patch.get_facecolor()[:3] for patch in axes.patches]
    assert fills[1:] == [pytest.approx(screen_colour(look_of(label, 0).colour)) for label in "2847"]
    assert len(set(fills)) == 5
    segments = sum(len(collection.get_paths()) for collection in axes.collections)
    assert segments == sum(GLYPHS[label].bit_count() for label in "2847")


def test_nothing_is_drawn_where_no_tile_is() -> None:
    film = change_of("4", "1", steps=10)
    axes = Figure().add_axes((0, 0, 1, 1))
    pictures.draw_tiles(axes, of_run(film), 20)
    assert len(axes.patches) == 5


def test_segments_of_a_digit_do_not_overlap_and_stay_in_their_tile() -> None:
    from matplotlib.path import Path as Outline

    outlines = [Outline(pictures.segment(name)) for name in "abcdefg"]
    for number, outline in enumerate(outlines):
        corners = np.asarray(outline.vertices, np.float64)
        assert corners.min() > 0.1
        assert corners.max() < 0.9
        assert not any(outline.intersects_path(other) for other in outlines[:number])


def test_a_gif_shows_every_picture_and_holds_two_at_a_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the frames of a film of twenty tiles each is 0.4 MB, and a recording may have 3,000."""
    reel, whole = of_run(change_of("4", "8", steps=4, between=2)), pictures._frame
    frames = [np.asarray(whole(reel, number), np.int16) for number in range(len(reel.pictures))]
    drawn: list[weakref.ref[Image.Image]] = []
    most = 0

    def watched(*given: object) -> Image.Image:
        nonlocal most
        frame = whole(*given)  # type: ignore[arg-type]
        drawn.append(weakref.ref(frame))
        most = max(most, sum(one() is not None for one in drawn))
        return frame

    monkeypatch.setattr(pictures, "_frame", watched)
    assert pictures.draw_gif(reel, tmp_path / "f.gif") == len(frames)
    assert most == 2
    with Image.open(tmp_path / "f.gif") as gif:
        assert (gif.n_frames, gif.info["loop"]) == (len(frames), 0)  # type: ignore[attr-defined]
        for number, (frame, picture) in enumerate(zip(frames, reel.pictures, strict=True)):
            gif.seek(number)
            assert gif.info["duration"] == round(1000 * picture.seconds)
            shown = np.asarray(gif.convert("RGB"), np.int16)
            assert np.abs(shown - frame).mean() < 2, "of 256 colours"


def test_a_gif_of_a_tall_array_is_no_taller_than_a_screen_can_show(tmp_path: Path) -> None:
    picture = Picture("0.0 s", True, (look_of("1", 1),) * 300, 0.5)
    cells = tuple((row, 0) for row in range(300))
    pictures.draw_gif(Reel("tall", "a line", cells, (picture,), (0,), 0), tmp_path / "f.gif")
    with Image.open(tmp_path / "f.gif") as gif:
        assert gif.height < 1600
