"""The processors that this process may use."""

import os


def processors_text() -> str:
    """How many there are, in words, with those of the machine that this process may not use."""
    usable, all_of_them = processors(), os.cpu_count() or 1
    if usable < all_of_them:
        return f"{usable} of {all_of_them} processors"
    return f"{usable} processor{'s' * (usable != 1)}"


def processors() -> int:
    """How many there are, 1 at least: those of the machine, or fewer where the process is bound to some."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
