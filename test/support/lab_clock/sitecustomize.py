"""Lets the commands that a test starts go by the test's clock, such as that of a lab's tiles.

Python imports this first wherever its folder is on the path, see `OwnedClock.environment`. A real tile's
second is everybody's; an emulated one's takes as long as this machine needs. So no command loses patience
with tiles that are slow only because the machine has other work.
"""

import mmap
import os
import struct
import time
from pathlib import Path

with Path(os.environ["TILENCA_LAB_CLOCK"]).open("rb") as _file:
    _clock = mmap.mmap(_file.fileno(), struct.calcsize("d"), access=mmap.ACCESS_READ)


class _Time:
    """As the functions of `time`, which stay functions where a class has them as attributes (pyserial)."""

    def __init__(self, offset_s: float) -> None:
        self._offset_s = offset_s

    def __call__(self) -> float:
        now_s: float = struct.unpack("d", _clock[:])[0]
        return self._offset_s + now_s


time.monotonic = _Time(0.0)
time.time = _Time(time.time() - time.monotonic())
