"""The processors that this process may use."""

import os


def processors() -> int:
    """How many there are, 1 at least: those of the machine, or fewer where the process is bound to some."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
