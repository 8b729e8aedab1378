"""Runs several independent emulations at once."""

import os
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

WORKERS = 2  # a shape may have threads of its own besides

Job = TypeVar("Job")
Result = TypeVar("Result")


def run_side_by_side(
    run: Callable[[Job, threading.Event], Result], jobs: Sequence[Job]
) -> Iterator[tuple[Job, Result]]:
    """Runs all jobs on a few threads.

    Args:
        run: runs one job; it must raise soon after the event is set, which stops all jobs.
        jobs: what to run.

    Yields:
        Each job and its result, in the order of `jobs`.

    Raises:
        Exception: `run` raised it; the first failure ends all.
    """
    stopped = threading.Event()
    with ThreadPoolExecutor(min(WORKERS, os.cpu_count() or 1)) as pool:
        try:
            yield from zip(jobs, pool.map(lambda job: run(job, stopped), jobs), strict=True)
        except BaseException:
            stopped.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
