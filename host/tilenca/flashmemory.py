"""What became of each board at its last flashing, for `tilenca flash --failed`."""

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path


def _file() -> Path:
    """Where programs keep such things for their user."""
    home = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(home) / "tilenca" / "failed.json"


def failed_boards() -> set[str]:
    """The names of the boards that are still to be flashed; an unreadable file is an empty one."""
    try:
        document = json.loads(_file().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return set()
    return {name for name in document if isinstance(name, str)} if isinstance(document, list) else set()


def remember(done: Mapping[str, bool]) -> None:
    """Keeps which boards failed; of those that are not in `done`, what was known stays.

    Args:
        done: whether each board, by name, runs what it should.
    """
    failed = (failed_boards() | done.keys()) - {name for name, well in done.items() if well}
    with suppress(OSError):  # a convenience: no flashing fails for want of it
        _file().parent.mkdir(parents=True, exist_ok=True)
        _file().write_text(json.dumps(sorted(failed), indent=1) + "\n", encoding="utf-8")
