"""Keys of a terminal: what they are called, what they do to a replay, and how the terminal is left."""

import io
import os
import pty
import select
import signal
import subprocess
import sys
import termios
from collections.abc import Iterator
from pathlib import Path
from typing import Self

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tilenca.fleet.recording import format_event
from tilenca.fleet.state import PortNews
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import TileSentence, format_sentence
from tilenca.views.keyboard import our_terminal, parse_keys

LIMIT_S = 60
SCREENFULS = 40_000
LEFT, RIGHT, UP, DOWN = b"\x1b[D", b"\x1b[C", b"\x1b[A", b"\x1b[B"
# So slow that only keys move it.
CRAWL = ["--speed", "0.001"]
# The terminal is the child's own, as a shell's would be; a child of the child is a job of its shell.
SHELL = """
import fcntl, os, signal, subprocess, sys, termios
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
signal.signal(signal.SIGTTOU, signal.SIG_IGN)
job = subprocess.Popen(sys.argv[1:], stderr=subprocess.PIPE, process_group=0)
os.tcsetpgrp(0, job.pid)
print(job.pid, file=sys.stderr, flush=True)
_, said = job.communicate()
sys.stderr.buffer.write(said)
print(job.returncode, file=sys.stderr)
"""


def test_keys_have_names_and_other_sequences_none() -> None:
    assert parse_keys(b"q \x1b[A\x1b[1;5C\x1bOD\x1b[3~x\x1b[15~\x1bOP") == (
        ["q", " ", "up", "right", "left", "x"],
        b"",
    )
    assert parse_keys(b"\x1bq") == (["q"], b"")


@given(st.lists(st.sampled_from([LEFT, RIGHT, UP, DOWN, b"q", b" ", b"\x1b[3~"]), max_size=6), st.data())
def test_keys_may_be_cut_anywhere(typed: list[bytes], data: st.DataObject) -> None:
    stream = b"".join(typed)
    keys, rest = [], b""
    for cut in [*sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=4))), len(stream)]:
        more, rest = parse_keys(rest + stream[:cut])
        keys += more
        stream = stream[cut:]
    more, rest = parse_keys(rest + stream)
    assert [*keys, *more] == parse_keys(b"".join(typed))[0]
    assert rest == b""


@given(st.binary())
def test_any_bytes_are_keys_or_nothing(data: bytes) -> None:
    keys, rest = parse_keys(data)
    assert all(len(key) == 1 or key in ("up", "down", "left", "right") for key in keys)
    assert data.endswith(rest)


class Replay:
    """A monitor that plays a recording on a terminal, as a shell's job; use it as a context manager."""

    def __init__(self, path: Path) -> None:
        self._terminal, self.inside = pty.openpty()
        termios.tcsetwinsize(self.inside, (30, 120))
        self.before = termios.tcgetattr(self.inside)
        command = [sys.executable, "-m", "tilenca.cli", "monitor", "--replay", str(path), *CRAWL]
        self._shell = subprocess.Popen(
            [sys.executable, "-c", SHELL, *command],
            stdin=self.inside,
            stdout=self.inside,
            stderr=subprocess.PIPE,
            env={**os.environ, "TERM": "xterm"},
            start_new_session=True,
            text=True,
        )
        assert self._shell.stderr is not None
        self.pid = int(self._shell.stderr.readline())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *about: object) -> None:
        self._shell.kill()
        self._shell.communicate()
        os.close(self._terminal)
        os.close(self.inside)

    def type(self, keys: bytes) -> None:
        os.write(self._terminal, keys)

    def read_until(self, wanted: str) -> str:
        """What the terminal shows, up to what is wanted."""
        seen = ""
        while wanted not in seen:
            ready, _, _ = select.select([self._terminal], [], [], LIMIT_S)
            assert ready, f"no {wanted!r} after {seen[-2000:]!r}"
            seen += os.read(self._terminal, 65536).decode("utf-8", "replace")
            assert len(seen) < SCREENFULS, f"no {wanted!r} in {seen[-2000:]!r}"
        return seen

    def end(self) -> int:
        """The job's exit status, after it has ended."""
        _, said = self._shell.communicate(timeout=LIMIT_S)
        assert "Traceback" not in said
        return int(said.split()[-1])

    @property
    def is_restored(self) -> bool:
        return termios.tcgetattr(self.inside) == self.before


@pytest.fixture
def replay(tmp_path: Path) -> Iterator[Replay]:
    """One of a tile that shows another digit every ten seconds."""
    path = tmp_path / "lab.jsonl"
    with path.open("w") as file:
        file.write(format_event(PortNews(1000.0, "p", is_open=True)))
        for second in range(100):
            tile = TileSentence(
                1, 1000 * second, second, str(second // 10), second // 10, 30, "----", bytes(21)
            )
            file.write(format_event(Heard(1000.0 + second, "p", format_sentence(tile).strip(), tile)))
    with Replay(path) as replay:
        replay.read_until("0 s, x 0.001; space: pause")
        yield replay


def test_keys_pause_move_and_speed_a_replay_and_q_ends_it(replay: Replay) -> None:
    assert not replay.is_restored, "keys come as they are typed"
    replay.type(b" ")
    replay.read_until("0 s, paused")
    replay.type(3 * RIGHT)
    replay.read_until("30 s, paused")
    assert "1 shows 3" in replay.read_until("30 s, paused")
    replay.type(LEFT)
    replay.read_until("20 s, paused")
    screen = replay.read_until("20 s, paused")
    assert "1 shows 2" in screen
    assert "shows 2, before 1" in screen
    assert "shows 3" not in screen, "it has not happened yet"
    replay.type(b" " + UP)
    replay.read_until("20 s, x 0.002")
    replay.type(b"q")
    assert replay.end() == 0
    assert replay.is_restored


@pytest.mark.parametrize(
    ("number", "status"),
    [(signal.SIGINT, 130), (signal.SIGTERM, 130), (signal.SIGHUP, 130), (signal.SIGQUIT, -signal.SIGQUIT)],
)
def test_whatever_ends_a_replay_the_terminal_is_as_it_was(
    replay: Replay, number: signal.Signals, status: int
) -> None:
    os.kill(replay.pid, number)
    assert replay.end() == status
    assert replay.is_restored


def test_ctrl_z_gives_the_terminal_back_until_the_job_goes_on(replay: Replay) -> None:
    replay.type(b"\x1a")
    with Path(f"/proc/{replay.pid}/stat").open() as stat:
        while stat.read().rpartition(")")[2].split()[0] != "T":
            stat.seek(0)
    assert replay.is_restored
    replay.read_until("\x1b[?25h")
    os.kill(replay.pid, signal.SIGCONT)
    replay.read_until("\x1b[?25l")
    replay.type(RIGHT)
    replay.read_until("10 s, x 0.001")
    assert not replay.is_restored
    replay.type(b"q")
    assert replay.end() == 0
    assert replay.is_restored


def test_without_a_terminal_to_type_on_no_keys_are_offered(tmp_path: Path) -> None:
    path = tmp_path / "lab.jsonl"
    path.write_text(format_event(Heard(1000.0, "p", b"", None)))
    screen, inside = pty.openpty()
    command = [sys.executable, "-m", "tilenca.cli", "monitor", "--replay", str(path)]
    done = subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        stdout=inside,
        stderr=subprocess.PIPE,
        env={**os.environ, "TERM": "xterm"},
        timeout=LIMIT_S,
        check=False,
    )
    os.close(inside)
    assert done.returncode == 0
    shown = b""
    while b"damaged" not in shown:
        shown += os.read(screen, 65536)
    os.close(screen)
    assert b"space" not in shown


def test_there_is_no_keyboard_where_standard_input_is_closed_or_no_terminal(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(sys, "stdin", None)
    assert our_terminal() is None, "closed before the program began"
    with (tmp_path / "file").open("w+") as file:
        monkeypatch.setattr(sys, "stdin", file)
        assert our_terminal() is None
    assert our_terminal() is None, "closed since"
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    assert our_terminal() is None
    master, slave = pty.openpty()
    with os.fdopen(slave) as terminal:
        monkeypatch.setattr(sys, "stdin", terminal)
        assert our_terminal() == slave
    os.close(master)
