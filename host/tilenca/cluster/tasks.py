"""Runs many tasks on a cluster, and hands each result over as soon as it is there.

A worker that dies or joins, or a scheduler that restarts, changes nothing but the time: a task whose result
has not arrived is run again.
"""

import queue
import time
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import count
from typing import Any, TypeVar

import distributed
from distributed.scheduler import KilledWorker

from tilenca.base.errors import BuildError, TilencaError
from tilenca.cluster.client import Check, Cluster
from tilenca.cluster.fingerprint import Fingerprint, fingerprint

Task = TypeVar("Task")
Result = TypeVar("Result")

AHEAD = 8  # tasks that the scheduler has for each thread of the workers
LEAST_AHEAD = 64
LOOK_S = 0.5
COUNT_S = 5.0  # from one count of the workers to the next
_run_numbers = count()


class MisfitError(TilencaError):
    """A worker that joined late has other software."""


def run_tasks(
    cluster: Cluster,
    function: Callable[[Any, Task], Result],
    shared: object,
    tasks: Sequence[Task],
    on_result: Callable[[Task, Result], Task | None],
    on_look: Callable[[], None] = lambda: None,
) -> None:
    """Runs `function(shared, task)` for all tasks, in any order.

    Args:
        cluster: where.
        function: of a module.
        shared: what all tasks need; it travels once to every worker.
        tasks: what to run.
        on_result: called in this thread with each task and its result, once for every task; it may return
            a further task.
        on_look: called in this thread every half second or so.

    Raises:
        TilencaError: the function raised it, or a worker cannot do the work; the message names the worker.
    """
    _Run(cluster, function, shared, tasks).run(on_result, on_look)


class _Run:
    """The state of `run_tasks`."""

    def __init__(
        self, cluster: Cluster, function: Callable[[Any, Any], Any], shared: object, tasks: Sequence[Any]
    ) -> None:
        self.cluster, self.function, self.shared, self.tasks = cluster, function, shared, list(tasks)
        self.waiting = deque(range(len(tasks)))
        self.running: dict[str, tuple[int, distributed.Future]] = {}
        self.ended: queue.SimpleQueue[str] = queue.SimpleQueue()
        self.ahead, self.counted_at = LEAST_AHEAD, -COUNT_S
        self.name = f"tilenca-{next(_run_numbers)}"
        self.sent = count()
        self.ours = fingerprint()
        self.common: distributed.Future | None = None

    def run(self, on_result: Callable[[Any, Any], Any], on_look: Callable[[], None]) -> None:
        """Runs all; cancels the rest where it ends early."""
        try:
            while self.waiting or self.running:
                with suppress(OSError):  # the scheduler has just gone; the next round connects anew
                    self._send()
                for number, result in self._collect():
                    more = on_result(self.tasks[number], result)
                    if more is not None:
                        self.waiting.append(len(self.tasks))
                        self.tasks.append(more)
                on_look()
        finally:
            if self.running and self.cluster.connected:
                self.cluster.client.cancel([future for _, future in self.running.values()], force=True)

    def _send(self) -> None:
        """Keeps the scheduler supplied, many tasks in one message."""
        if not self.cluster.connected:
            self._start_anew()
        if time.monotonic() - self.counted_at > COUNT_S:
            self.ahead = max(LEAST_AHEAD, AHEAD * self.cluster.threads())
            self.counted_at = time.monotonic()
        if not self.waiting or len(self.running) > self.ahead // 2:
            return
        client = self.cluster.client
        if self.common is None:
            # A task, not scattered data: where its worker dies, Dask makes it again.
            self.common = client.submit(_same, self.shared, key=f"{self.name}-common-{next(self.sent)}")
        numbers = [
            self.waiting.popleft() for _ in range(min(self.ahead - len(self.running), len(self.waiting)))
        ]
        keys = [f"{self.name}-{next(self.sent)}" for _ in numbers]
        futures = client.map(
            _work,
            [self.tasks[number] for number in numbers],
            function=self.function,
            shared=self.common,
            ours=self.ours,
            check=self.cluster.check,
            key=keys,
        )
        for key, number, future in zip(keys, numbers, futures, strict=True):
            self.running[key] = number, future
            future.add_done_callback(lambda _, key=key: self.ended.put(key))

    def _collect(self) -> list[tuple[int, Any]]:
        """What has arrived; waits a moment for the first."""
        keys = []
        try:
            keys.append(self.ended.get(timeout=LOOK_S))
            while True:
                keys.append(self.ended.get_nowait())
        except queue.Empty:
            pass
        done = [(key, *self.running.pop(key)) for key in keys if key in self.running]
        finished = [(number, future) for _, number, future in done if future.status == "finished"]
        for _, _, future in done:
            if future.status == "error":
                raise self._failure(future.exception())
        try:
            results = self.cluster.client.gather([future for _, future in finished], errors="raise")
        except (OSError, distributed.CancelledError):  # the scheduler went away
            finished, results = [], []
        if len(finished) < len(done):
            self.waiting.extendleft({number for _, number, _ in done} - {number for number, _ in finished})
            self._forget()
        return list(zip((number for number, _ in finished), results, strict=True))

    def _forget(self) -> None:
        """Takes back all that was sent: a scheduler that restarted does not know it."""
        self.waiting.extendleft(number for number, _ in self.running.values())
        self.running.clear()
        self.common = None

    def _start_anew(self) -> None:
        """After the loss of the scheduler: connects again, and sends again what has not arrived."""
        self._forget()
        self.cluster.reconnect()
        self.counted_at = -COUNT_S

    def _failure(self, error: BaseException) -> BaseException:
        """What to raise for a task that failed."""
        if isinstance(error, KilledWorker):
            return TilencaError(
                "several workers died on the same task, perhaps for want of memory; give them more of it, "
                "or each machine fewer of them"
            )
        if isinstance(error, MisfitError | ImportError):
            self.cluster.check_workers()  # names the worker
        return error


def _same(value: Any) -> Any:
    return value


def _work(
    task: Any, function: Callable[[Any, Any], Any], shared: Any, ours: Fingerprint, check: Check | None
) -> Any:
    """Runs one task in a worker, which may have joined unseen; a failure names the worker."""
    try:
        if differences := ours.differences(fingerprint()):
            raise MisfitError(f"has {differences}; install the same wheel on every machine")
        if check is not None:
            check()
        return function(shared, task)
    except (TilencaError, OSError, MemoryError) as error:
        kind = type(error) if isinstance(error, MisfitError | BuildError) else TilencaError
        fact = str(error) or "out of memory"
        raise kind(f"worker {distributed.get_worker().address}: {fact}") from error
