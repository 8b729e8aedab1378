"""What a film shows: runs step by step, and recordings whenever something is new."""

import json
from collections.abc import Iterable
from itertools import islice
from pathlib import Path

import pytest

from support.films import change_of, film_of
from support.schemas import fits
from tilenca import cli
from tilenca.base import paths
from tilenca.base.errors import TilencaError, UsageError
from tilenca.fleet.recording import format_event
from tilenca.fleet.state import PortNews
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import LinkSentence, Sentence, TileSentence, format_sentence
from tilenca.protocol.stream import place_event
from tilenca.shapes.file import load_task
from tilenca.shapes.glyphs import DARK_LOOK, look_of
from tilenca.views.reel import LAST_S, LEAST_S, MOST_S, of_recording, of_run

STATE = bytes(range(1, 22))


def tile(number: int, label: str, links: str = "----") -> TileSentence:
    return TileSentence(number, 1000, 10, label, int(label), 30, links, STATE)


def written(path: Path, sentences: Iterable[tuple[float, Sentence]]) -> Path:
    """A recording of lines at their times, in seconds; each tile has a port of its own."""
    heard = [
        Heard(100 + at_s, f"/dev/ttyACM{line.tile}", format_sentence(line), line) for at_s, line in sentences
    ]
    path.write_text("".join(map(format_event, heard)), encoding="ascii")
    return path


def test_a_run_has_a_picture_for_each_step_and_says_when_all_are_right() -> None:
    film = film_of("4")
    reel = of_run(film)
    assert len(reel.pictures) == 13
    assert reel.title == f"“4”: every tile right from step {film.agreed_at}"
    assert reel.size == (5, 4)
    assert set(reel.pictures[0].looks) == {DARK_LOOK}
    assert set(reel.pictures[-1].looks) == {look_of("4", 4)}
    assert reel.pictures[-1].seconds == LAST_S
    assert of_run(film_of("4", steps=2)).title == "“4”: not every tile right at the end"


def test_a_tile_that_is_not_there_is_not_in_the_picture() -> None:
    reel = of_run(change_of("4", "1", steps=10))
    assert sum(look is not None for look in reel.pictures[5].looks) == 10
    assert sum(look is not None for look in reel.pictures[-1].looks) == 5


def test_a_recording_has_a_picture_whenever_something_is_new(tmp_path: Path) -> None:
    lines: list[tuple[float, Sentence]] = [
        (0.0, tile(1, "7")),
        (0.05, tile(2, "7", "---W")),
        (0.3, LinkSentence(2, 1001, "W", 10, 9, 0, 0, 0, 15, 0, 1, "E")),
        (0.35, LinkSentence(1, 1001, "E", 10, 9, 0, 0, 0, 15, 0, 2, "W")),
        *((0.4 + 0.1 * turn, tile(1 + turn % 2, "7")) for turn in range(20)),
        (2.5, tile(1, "4")),
        *((2.55 + 0.1 * turn, tile(2, "4")) for turn in range(15)),
    ]
    reel = of_recording(written(tmp_path / "r.jsonl", lines))
    assert reel.cells == ((0, 0), (0, 1))
    shown = [[look and look.label for look in picture.looks] for picture in reel.pictures]
    assert shown == [["7", ""], ["7", "7"], ["4", "7"], ["4", "4"], ["", "4"]]
    assert [picture.agreed for picture in reel.pictures] == [False, True, False, True, False]
    assert reel.pictures[1].seconds == MOST_S
    assert reel.pictures[2].seconds == pytest.approx(LEAST_S)
    assert reel.agreed_at is None
    assert reel.title == "2 tiles: 1 shows nothing, 1 shows 4"
    assert reel.about == "r.jsonl, 4.0 s recorded"


def test_emulated_tiles_lie_as_they_are_plugged_together_and_go_dark_without_power(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    words = ("--shape", "4", "--seconds", "5", "--fault", "off@4:2.5-4", "--record", str(path))
    assert cli.main(["emulate", *words]) in (0, 1)
    reel = of_recording(path)
    assert reel.cells == load_task(paths.DEFAULT_SHAPES).find("4").cells
    assert reel.size == (5, 4)
    agreed = [number for number, picture in enumerate(reel.pictures) if picture.agreed]
    with path.open(encoding="ascii") as lines:
        assert all(fits("recording", json.loads(line)) for line in islice(lines, 20))
    number_4 = reel.cells.index((1, 3))
    dark = [n for n, picture in enumerate(reel.pictures) if picture.looks[number_4] == DARK_LOOK]
    assert any(number > agreed[0] for number in dark), "without power after all agreed"


def test_a_tile_that_was_cut_off_and_one_that_is_silent_stay_in_their_places(tmp_path: Path) -> None:
    path = written(tmp_path / "r.jsonl", [(0.0, tile(1, "7")), (0.3, tile(2, "7")), (0.5, tile(1, "7"))])
    places = [place_event(100, f"/dev/ttyACM{n}", (n, 1), n) for n in (1, 2, 3)]
    path.write_text("".join(f"{json.dumps(event)}\n" for event in places) + path.read_text(encoding="ascii"))
    reel = of_recording(path)
    assert reel.cells == ((0, 0), (1, 0), (2, 0))
    assert [look and look.label for look in reel.pictures[-1].looks] == ["7", "7", ""]


def test_what_cannot_be_filmed_is_told(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    with pytest.raises(UsageError, match=r"r\.jsonl: No such file"):
        of_recording(path)
    news = PortNews(1.0, "/dev/ttyACM0", is_open=True)
    path.write_text(format_event(news), encoding="ascii")
    with pytest.raises(TilencaError, match="no tile says in it what it shows"):
        of_recording(path)
    written(path, [(0.0, tile(1, "7"))])
    gone = json.dumps(place_event(200, "/dev/ttyACM1", None))
    path.write_text(f"{path.read_text(encoding='ascii')}{gone}\n", encoding="ascii")
    with pytest.raises(TilencaError, match="no tile lies on the board at the recording's end"):
        of_recording(path)
    written(path, [(0.0, tile(1, "7"))])
    events = [json.loads(line) for line in path.read_text(encoding="ascii").splitlines()]
    path.write_text(
        "".join(json.dumps({**event, "shape": shape}) + "\n" for event in events for shape in "47"),
        encoding="ascii",
    )
    with pytest.raises(UsageError, match="has runs of 4, 7, one after the other"):
        of_recording(path)
