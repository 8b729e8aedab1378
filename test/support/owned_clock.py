"""A clock that a test owns and programs under test go by: see `lab_clock/sitecustomize.py`."""

import mmap
import os
import struct
from pathlib import Path

from tilenca.base import paths

PATCH = Path(__file__).with_name("lab_clock")


class OwnedClock:
    """A number of seconds in a file. It stands still unless the test moves it.

    Attributes:
        environment: for the programs that are to go by this clock.
    """

    def __init__(self, file: Path) -> None:
        """Starts at zero, in a new file."""
        file.write_bytes(bytes(struct.calcsize("d")))
        with file.open("r+b") as opened:
            self._memory = mmap.mmap(opened.fileno(), 0)
        self.environment = {
            **os.environ,
            "PYTHONPATH": f"{PATCH}:{paths.ROOT / 'host'}",
            "TILENCA_LAB_CLOCK": str(file),
        }

    @property
    def seconds(self) -> float:
        """What it says."""
        now_s: float = struct.unpack("d", self._memory[:])[0]
        return now_s

    @seconds.setter
    def seconds(self, now_s: float) -> None:
        self._memory[:] = struct.pack("d", now_s)
