"""Streams that are closed, full, or a pipe whose reader has gone."""

import io
import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from tilenca.base.errors import TilencaError
from tilenca.base.stdio import check_streams, finish_streams, warn


@contextmanager
def without_room() -> Iterator[None]:
    """Neither stream has room; as at the end of a process both are closed, which writes what is left."""
    with pytest.MonkeyPatch.context() as patch, ExitStack() as streams:
        for name in ("stdout", "stderr"):
            stream = streams.enter_context(Path("/dev/full").open("w"))
            patch.setattr(sys, name, stream)
        yield
        patch.undo()


def test_chatter_goes_to_stderr_as_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    warn("three tiles are missing")
    assert capsys.readouterr() == ("", "three tiles are missing\n")


def test_chatter_that_has_no_room_ends_nothing_now_or_later() -> None:
    with without_room():
        warn("nobody hears this")
        warn("nor this")


def test_a_result_that_has_no_room_is_an_error() -> None:
    with without_room():
        print("a result")
        with pytest.raises(TilencaError, match="standard output: No space left on device; the result is"):
            finish_streams()


def test_a_reader_that_has_gone_has_seen_what_it_wanted(monkeypatch: pytest.MonkeyPatch) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "w") as pipe, monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", pipe)
        print("a result")
        finish_streams()


def test_without_stdout_no_command_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    with pytest.raises(TilencaError, match="standard output is closed; redirect it"):
        check_streams()


def test_without_stderr_chatter_does_not_go_to_stdout(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(sys, "stderr", None)
        check_streams()
        warn("chatter")
        replacement = sys.stderr
    replacement.close()
    assert capsys.readouterr().out == ""


def test_a_locale_without_a_character_shows_its_number(monkeypatch: pytest.MonkeyPatch) -> None:
    written = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(written, encoding="ascii"))
    check_streams()
    print("ü", flush=True)
    assert written.getvalue() == b"\\xfc\n"
