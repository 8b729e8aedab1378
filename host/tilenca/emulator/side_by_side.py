"""Runs several independent emulations at once."""

import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from tilenca.base.processors import processors

Job = TypeVar("Job")
Result = TypeVar("Result")


def at_once(jobs: int) -> int:
    """How many of so many jobs run at once, 1 at least."""
    return max(1, min(jobs, processors()))


def threads_of_each(jobs: int) -> int:
    """How many threads each of so many jobs may have, so that all processors have work."""
    return processors() // at_once(jobs)


def run_side_by_side(
    run: Callable[[Job, threading.Event], Result], jobs: Sequence[Job]
) -> Iterator[tuple[Job, Result]]:
    """Runs all jobs, as many at once as there are processors.

    Args:
        run: runs one job; it must raise soon after the event is set, which stops all jobs.
        jobs: what to run.

    Yields:
        Each job and its result, in the order of `jobs`.

    Raises:
        Exception: `run` raised it; the first failure ends all.
    """
    stopped = threading.Event()
    with ThreadPoolExecutor(at_once(len(jobs))) as pool:
        try:
            yield from zip(jobs, pool.map(lambda job: run(job, stopped), jobs), strict=True)
        except BaseException:
            stopped.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
