"""A real Dask scheduler and real worker processes, which a test may kill and start again."""

import logging
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import distributed

ENDS_WITHIN_S = 20
TESTS = Path(__file__).resolve().parents[1]  # so that workers find `support`


class Machines:
    """A scheduler at an address of its own, and its workers, each a process with one thread."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.workers: list[subprocess.Popen[bytes]] = []
        self.scheduler = self._start_scheduler()

    def _start(self, *words: str, more: Sequence[str] = ()) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [sys.executable, "-m", "dask", *words, "--no-dashboard"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE if words[0] == "scheduler" else subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": os.pathsep.join([*more, str(TESTS)])},
            cwd=self._folder,
        )

    def _start_scheduler(self) -> subprocess.Popen[bytes]:
        """Starts it, and waits until it listens."""
        scheduler = self._start("scheduler", "--host", "127.0.0.1", "--port", f"{self.port}")
        assert scheduler.stderr is not None
        said = []
        for line in iter(scheduler.stderr.readline, b""):
            said.append(line)
            if self.address.encode() in line:
                return scheduler
        raise AssertionError(b"".join(said).decode())

    def add_worker(self, *more: Path) -> subprocess.Popen[bytes]:
        """Starts a worker, which joins when it is ready.

        Args:
            more: folders of packages that it has instead of ours.
        """
        words = "worker", self.address, "--no-nanny", "--nthreads", "1"
        worker = self._start(*words, more=[str(folder) for folder in more])
        self.workers.append(worker)
        return worker

    def kill(self, process: "subprocess.Popen[bytes]") -> None:
        """Kills a process at once, as a loss of power does."""
        process.send_signal(signal.SIGKILL)
        process.wait(ENDS_WITHIN_S)
        if process.stderr is not None:
            process.stderr.close()

    def restart(self) -> None:
        """Kills the scheduler and all workers, and starts a scheduler at the same address, and one worker."""
        for process in (self.scheduler, *self.workers):
            self.kill(process)
        self.workers.clear()
        self.scheduler = self._start_scheduler()
        self.add_worker()


@contextmanager
def machines(folder: Path, workers: int) -> Iterator[Machines]:
    """A scheduler and so many workers; none is left at the end of the block."""
    folder.mkdir()
    started = Machines(folder)
    try:
        for _ in range(workers):
            started.add_worker()
        yield started
    finally:
        for process in (started.scheduler, *started.workers):
            started.kill(process)


@contextmanager
def in_this_process(workers: int) -> Iterator[str]:
    """The address of a scheduler in this process, with so many workers of one thread."""
    with distributed.LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        processes=False,
        protocol="tcp://",
        host="127.0.0.1",
        dashboard_address=None,
        silence_logs=logging.CRITICAL,
    ) as cluster:
        yield str(cluster.scheduler_address)
