"""Runs other programs so that none can wait for an answer, and remembers which steps are done."""

import hashlib
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class SetupError(Exception):
    """The set-up cannot go on; the message names the remedy. The caller prints it and exits."""


def say(message: str) -> None:
    """Tells the user the current step, on standard error."""
    print(f"setup: {message}", file=sys.stderr, flush=True)


def run(
    command: Sequence[str | Path], failure: str, env: Mapping[str, str] | None = None, quiet: bool = False
) -> None:
    """Runs a command in the project's root, with nothing to read from.

    Args:
        command: the program and its arguments.
        failure: the message to the user if it fails, with the remedy.
        env: the whole environment, if not the present one.
        quiet: whether its output is shown only where it fails.

    Raises:
        SetupError: it could not be started or did not end with 0.
    """
    try:
        done = subprocess.run(
            [str(word) for word in command],
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE if quiet else None,
            stderr=subprocess.STDOUT if quiet else None,
            env=env,
            check=False,
        )
    except OSError as error:
        raise SetupError(f"{failure} ({error})") from error
    if done.returncode:
        sys.stderr.write((done.stdout or b"").decode(errors="replace"))
        raise SetupError(f"{failure} (exit status {done.returncode})")


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
