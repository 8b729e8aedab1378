"""What only one of the processes that run tests may do at a time."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager

from tilenca.base import paths


@contextmanager
def alone(what: str) -> Iterator[None]:
    """Waits until no other process of this clone is in a block of this name.

    Args:
        what: names the thing that the processes share, such as a folder they build in.
    """
    folder = paths.BUILD / "test"
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / f"{what}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
