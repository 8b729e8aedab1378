"""Functions that tests run in workers, which import them from here."""

import os
from typing import Any

from tilenca.base.errors import BuildError, UsageError


def missing() -> None:
    """A check that fails."""
    raise BuildError("no simulator; run: make setup")


def other_version(wanted: str) -> None:
    """A check that finds another version than the wanted one."""
    raise UsageError(f"PyTorch 0.1 instead of {wanted}; install the same everywhere")


def pid() -> int:
    """Of the process that calls it."""
    return os.getpid()


def times(factor: int, task: int) -> int:
    """The product."""
    return factor * task


def refuse(_: Any, task: int) -> int:
    """Refuses one of the tasks."""
    if task == 7:
        raise BuildError("no library")
    return task


def full(_: Any, task: int) -> int:
    """As on a full disk."""
    raise OSError(28, "No space left on device")


def defect(_: Any, task: int) -> int:
    """A mistake in the program."""
    raise ZeroDivisionError
