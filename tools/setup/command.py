"""Runs other programs so that none can wait for an answer, and remembers which steps are done.

Steps may run side by side: what a program prints is shown in one piece, and only where it fails.
"""

import hashlib
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class SetupError(Exception):
    """The set-up cannot go on; the message names the remedy. The caller prints it and exits."""


class StoppedError(SetupError):
    """A step did not end, or did not start, because another one failed."""


class _Programs:
    """The programs that run now, and whether more may start."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.running: set[subprocess.Popen[bytes]] = set()
        self.stopped = False
        self.lines_said = 0


_programs = _Programs()


def say(message: str) -> None:
    """Tells the user the current step, on standard error, as one line."""
    _programs.lines_said += 1
    sys.stderr.write(f"setup: {message}\n")
    sys.stderr.flush()


def has_said_something() -> bool:
    """Whether there was anything to do."""
    return _programs.lines_said > 0


def stop() -> None:
    """Ends the programs that run now, with all that they have started; none starts any more."""
    with _programs.lock:
        _programs.stopped = True
        for program in _programs.running:
            with suppress(ProcessLookupError):  # it has just ended
                os.killpg(program.pid, signal.SIGTERM)


def run(command: Sequence[str | Path], failure: str, env: Mapping[str, str] | None = None) -> None:
    """Runs a command in the project's root, with nothing to read from; shows its output only where it fails.

    Args:
        command: the program and its arguments.
        failure: the message to the user if it fails, with the remedy.
        env: the whole environment, if not the present one.

    Raises:
        SetupError: it could not be started or did not end with 0.
        StoppedError: `stop` was called.
    """
    with _programs.lock:
        if _programs.stopped:
            raise StoppedError("another step failed")
        try:
            program = subprocess.Popen(
                [str(word) for word in command],
                cwd=ROOT,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                env=env,
                process_group=0,  # with which `stop` ends its children, too
            )
        except OSError as error:
            raise SetupError(f"{failure} ({error})") from error
        _programs.running.add(program)
    try:
        output, _ = program.communicate()
    finally:
        with _programs.lock:
            _programs.running.discard(program)
    if program.returncode and _programs.stopped:
        raise StoppedError("another step failed")
    if program.returncode:
        sys.stderr.write(output.decode(errors="replace"))
        raise SetupError(f"{failure} (exit status {program.returncode})")


def digest(parts: Iterable[str | bytes]) -> str:
    """One key for the content that a step depends on; any change in any part changes it."""
    total = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        total.update(len(data).to_bytes(8, "little") + data)
    return total.hexdigest()


class Stamp:
    """A small file with the content for which a step was done last.

    It lies inside the step's product, so that deleting the product deletes the record too.
    """

    def __init__(self, path: Path, key: str) -> None:
        self._path = path
        self._key = key

    def is_current(self) -> bool:
        """Whether the step was done for exactly this content."""
        try:
            return self._path.read_text(encoding="ascii").strip() == self._key
        except (OSError, UnicodeDecodeError):
            return False

    def clear(self) -> None:
        """Deletes the record: call it before the step starts, so that a failed step is done again."""
        self._path.unlink(missing_ok=True)

    def set(self) -> None:
        """Records that the step is done."""
        self._path.parent.mkdir(parents=True, exist_ok=True)
        self._path.write_text(self._key + "\n", encoding="ascii")
