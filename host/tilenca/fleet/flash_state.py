"""The boards whose last flashing failed, on disk, for `tilenca flash --failed`."""

import fcntl
import json
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from tilenca.base.parsing import read_json


def _file() -> Path:
    """The user's folder for the state of programs; RuntimeError if the user has no home."""
    home = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(home) / "tilenca" / "failed.json"


def failed_boards() -> set[str]:
    """The names of the boards that are still to be flashed; an unreadable file is an empty one."""
    try:
        return _names(_file().read_text(encoding="utf-8", errors="replace"))
    except (OSError, RuntimeError):
        return set()


def _names(text: str) -> set[str]:
    try:
        document = read_json(text)
    except ValueError:
        return set()
    return {name for name in document if isinstance(name, str)} if isinstance(document, list) else set()


def remember(done: Mapping[str, bool]) -> None:
    """Records which boards failed; boards that are not in `done` keep their status.

    Args:
        done: whether each board, by name, runs what it should.
    """
    with suppress(OSError, RuntimeError):  # a convenience: no flashing fails for want of it
        path = _file()
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.with_suffix(".lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)  # another call may end at the same moment
            failed = (failed_boards() | done.keys()) - {name for name, well in done.items() if well}
            beside = path.with_suffix(".part")  # without room, the recorded status stays
            beside.write_text(json.dumps(sorted(failed), indent=1) + "\n", encoding="utf-8")
            beside.replace(path)
