"""When a model was trained and for how long."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given

from support.strategies import damaged
from tilenca.base.errors import TilencaError
from tilenca.training import sessions
from tilenca.training.sessions import FILE, noted, sessions_of


class Clock:
    """Ten seconds pass between any two looks at it."""

    def __init__(self) -> None:
        self.seconds = 0.0

    def monotonic(self) -> float:
        self.seconds += 10.0
        return self.seconds


@pytest.fixture(autouse=True)
def _clock(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sessions, "time", Clock())


def test_a_session_is_noted_when_it_begins_and_its_time_when_it_ends(tmp_path: Path) -> None:
    with noted(tmp_path, "tilenca train", "quick", goes_on=False):
        (running,) = sessions_of(tmp_path)
        assert running.seconds is None
        assert running.is_running
    (ended,) = sessions_of(tmp_path)
    assert ended == replace(running, seconds=10.0)
    assert (ended.command, ended.recipe) == ("tilenca train", "quick")
    assert not ended.is_running


def test_an_interrupted_session_counts_and_the_next_one_goes_on_or_begins_anew(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), noted(tmp_path, "tilenca train", "quick", goes_on=False):
        raise KeyboardInterrupt
    for goes_on, count in ((True, 2), (False, 1)):
        with noted(tmp_path, "tilenca train", "quick", goes_on):
            pass
        assert [one.seconds for one in sessions_of(tmp_path)] == [10.0] * count


def test_a_model_that_stays_keeps_its_own_sessions(tmp_path: Path) -> None:
    other = tmp_path / "model-1234"
    other.mkdir()
    with noted(tmp_path, "first", "full", goes_on=False):
        pass
    with noted(tmp_path, "second", "quick", goes_on=False) as session:
        session.moved(tmp_path)
        assert [one.command for one in sessions_of(tmp_path)] == ["second"]
        session.moved(other)
    assert [one.command for one in sessions_of(tmp_path)] == ["first"]
    assert [(one.command, one.seconds) for one in sessions_of(other)] == [("second", 10.0)]


def test_a_session_that_was_killed_or_is_elsewhere_does_not_run(tmp_path: Path) -> None:
    with noted(tmp_path, "tilenca train", "quick", goes_on=False):
        (mine,) = sessions_of(tmp_path)
    assert not replace(mine, host="elsewhere").is_running
    again = replace(mine, seconds=None)
    assert again.is_running
    for pid in (2**22 + 1, 2**80):
        assert not replace(again, pid=pid).is_running, "no process has such a number"
        assert not replace(again, pid=pid, started=None).is_running


def test_another_process_that_has_the_number_now_is_not_the_session(tmp_path: Path) -> None:
    with noted(tmp_path, "tilenca train", "quick", goes_on=False):
        (mine,) = sessions_of(tmp_path)
        assert mine.started is not None, "Linux tells it"
        boot, ticks = mine.started.split()
        assert not replace(mine, started=f"{boot} {int(ticks) + 1}").is_running
        assert not replace(mine, started=f"0{boot} {ticks}").is_running
        assert replace(mine, started=None).is_running, "a file of before tells no time"


def _file(**changed: object) -> str:
    about = {"began": "now", "command": "", "recipe": "quick", "seconds": 1.0, "host": "", "pid": 1}
    return json.dumps([about | changed])


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{}",
        '[{"began": "now"}]',
        "[1]",
        _file(seconds="1"),
        _file(pid="1"),
        _file(pid=-1),
        _file(recipe=3),
    ],
)
def test_a_damaged_file_says_nothing(text: str, tmp_path: Path) -> None:
    (tmp_path / FILE).write_text(text)
    assert sessions_of(tmp_path) == []


def test_the_first_failure_is_the_one_that_is_told(tmp_path: Path) -> None:
    folder = tmp_path / "model"

    def fail() -> None:
        with noted(folder, "", "quick", goes_on=False):
            (folder / FILE).unlink()
            folder.rmdir()
            raise ValueError("of its own")

    folder.mkdir()
    with pytest.raises(ValueError, match="of its own"):
        fail()
    with pytest.raises(TilencaError, match="give another --out"), noted(folder, "", "quick", goes_on=False):
        pass


@given(damaged(b'[{"began": "a", "command": "b", "recipe": "c", "seconds": null, "host": "h", "pid": 3}]'))
def test_any_bytes_are_sessions_or_none(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    folder = tmp_path_factory.mktemp("fuzz")
    (folder / FILE).write_bytes(content)
    assert all(isinstance(session.is_running, bool) for session in sessions_of(folder))
