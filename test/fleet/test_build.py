"""Building the firmware before it is written."""

import os
import shlex
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from support.bootloader_stand_in import StandIn
from tilenca.base import paths
from tilenca.base.errors import BuildError
from tilenca.cli import main
from tilenca.fleet.build import CANCELLED, build

LIMIT_S = 60


def test_an_interrupted_build_leaves_nothing_running(tmp_path: Path) -> None:
    """The "pio" here starts a compiler of its own, as the real one does, and says both their numbers."""
    told = tmp_path / "told"
    os.mkfifo(told)
    program = f"sleep 600 & echo $$ $! > {shlex.quote(str(told))}; wait"
    (tmp_path / "pio").write_text(f"#!/bin/sh\n{program}\n")
    (tmp_path / "pio").chmod(0o755)
    # `pio` is looked for beside the interpreter.
    script = "import sys; sys.executable = sys.argv.pop(1); from tilenca.cli import main; sys.exit(main())"
    with StandIn() as board:
        interpreter = str(tmp_path / "python")
        words = [sys.executable, "-c", script, interpreter, "flash", "--port", board.port]
        flashing = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
        started = [Path("/proc") / number for number in told.read_text().split()]
        assert all(process.exists() for process in started)
        flashing.send_signal(signal.SIGTERM)
        _, chatter = flashing.communicate(timeout=LIMIT_S)
    assert flashing.returncode == 130, chatter
    assert [_runs(process) for process in started] == [False, False]


def test_a_cancelled_build_leaves_nothing_running(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    told = tmp_path / "told"
    os.mkfifo(told)
    (tmp_path / "pio").write_text(f"#!/bin/sh\nsleep 600 & echo $$ $! > {shlex.quote(str(told))}; wait\n")
    (tmp_path / "pio").chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    cancelled, reasons = threading.Event(), []

    def building() -> None:
        try:
            build(tmp_path, quiet=True, cancelled=cancelled)
        except BuildError as error:
            reasons.append(str(error))

    thread = threading.Thread(target=building)
    thread.start()
    started = [Path("/proc") / number for number in told.read_text().split()]
    assert all(map(_runs, started))
    cancelled.set()
    thread.join(LIMIT_S)
    assert reasons == [CANCELLED]
    assert [_runs(process) for process in started] == [False, False]


def _runs(process: Path) -> bool:
    """Whether a process runs; one that has ended may wait for its parent to notice (state Z)."""
    try:
        return (process / "stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_a_failed_build_shows_its_output_and_exits_with_4(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(paths, "PROJECT", tmp_path)  # no project there
    with StandIn() as board:
        assert main(["flash", "--port", board.port]) == 4
        assert not board.heard.is_set()
    captured = capfd.readouterr()
    assert captured.out == ""
    assert "platformio.ini" in captured.err
    assert captured.err.splitlines()[-1].startswith("tilenca: `")
