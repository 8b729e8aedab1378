"""A Dask client: its own workers on this machine, or a scheduler elsewhere. Needs the extra `sweep`."""

import gc
import logging
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import metadata
from pathlib import Path
from typing import Any

from tilenca.base.errors import TilencaError, UsageError
from tilenca.base.parsing import read_json
from tilenca.base.project import install_remedy
from tilenca.base.stdio import warn
from tilenca.cluster.fingerprint import fingerprint

try:
    import distributed
except ImportError as error:
    raise UsageError(
        f"this needs Dask distributed, which is not installed; run: {install_remedy('sweep')}"
    ) from error

CONNECT_S = 10.0
PATIENCE_S = 600.0  # for a scheduler that restarts, and for the first worker
LOOK_S = 0.5
START = "dask scheduler, and on each machine: dask worker ADDRESS"

# Called in every worker before it gets work, and before each task, so it should be quick when called again;
# raises what is missing there.
Check = Callable[[], None]


class Cluster:
    """A connection to a scheduler and its workers.

    Args:
        scheduler: its address, or the file that it writes (`--scheduler-file`); None: workers of its own.
        jobs: how many of its own.
        check: called in every worker before it gets work.
        patience_s: how long to wait for a scheduler that went away, and for a first worker.

    Raises:
        UsageError: no scheduler answers, or a worker has another version of tilenca.
        TilencaError: there is no worker in time.
    """

    def __init__(
        self, scheduler: str | None, jobs: int, check: Check | None = None, patience_s: float = PATIENCE_S
    ) -> None:
        self.scheduler, self.check, self.patience_s = scheduler, check, patience_s
        self._local: Any = None
        _silence()
        if scheduler is None:
            with _deaf_to_ctrl_c():
                self._local = _local_cluster(jobs)
        try:
            self.client = self._connect()
            self.check_workers()
        except BaseException:
            self.close()
            raise

    def _connect(self) -> distributed.Client:
        more: dict[str, Any] = {"timeout": CONNECT_S, "set_as_default": False}
        try:
            return distributed.Client(self._local or _address_of(str(self.scheduler)), **more)
        except (OSError, ValueError, TypeError, ImportError) as error:
            fact = "no Dask scheduler answers there" if isinstance(error, OSError) else f"{error}"
        # The failed client goes now: collected while another one starts, it would wait for its lock.
        gc.collect()
        raise UsageError(f"--scheduler {self.scheduler}: {fact}; start one with: {START}")

    def reconnect(self) -> None:
        """Connects anew to a scheduler that went away, as soon as it is back.

        Raises:
            TilencaError: it does not come back in time.
        """
        warn(f"the scheduler {self.scheduler} went away; waiting for it to come back")
        with suppress(Exception):  # what is left of a broken connection
            self.client.close(timeout=1)
        give_up = time.monotonic() + self.patience_s
        while not self._is_back():
            if time.monotonic() > give_up:
                raise TilencaError(
                    f"the scheduler {self.scheduler} did not come back in {self.patience_s:.0f} s; start it"
                )
            time.sleep(LOOK_S)
        self.check_workers()

    def _is_back(self) -> bool:
        try:
            self.client = self._connect()
        except UsageError:
            return False
        return True

    @property
    def connected(self) -> bool:
        """Whether the scheduler is there."""
        return bool(self.client.status == "running")

    def threads(self) -> int:
        """How many tasks the workers run at once."""
        return sum(self.client.nthreads().values())

    def workers(self) -> int:
        """How many workers there are."""
        return len(self.client.nthreads())

    def check_workers(self) -> None:
        """Waits for a worker, and refuses one on which results could differ.

        Raises:
            UsageError: a worker has no tilenca, or another version; the message names it.
            TilencaError: no worker came in time, or one lacks what the check asks for.
        """
        give_up, told = time.monotonic() + self.patience_s, False
        while not self.workers():
            if not told:
                warn(f"waiting for a first worker of {self.client.scheduler.address}")
                told = True
            if time.monotonic() > give_up:
                raise TilencaError(
                    f"{self.scheduler}: no worker in {self.patience_s:.0f} s; start one with: {START}"
                )
            time.sleep(LOOK_S)
        ours = fingerprint()
        for who, version in self._everywhere(metadata.version, "tilenca"):
            if version != ours.tilenca:
                fact = f"tilenca {version}" if isinstance(version, str) else "no tilenca"
                raise _misfit(who, f"has {fact}, here is {ours.tilenca}")
        for who, theirs in self._everywhere(fingerprint):
            fact = f"{theirs}" if isinstance(theirs, BaseException) else ours.differences(theirs)
            if fact:
                raise _misfit(who, f"has {fact}")
        if self.check is not None:
            for address, outcome in self.client.run(self.check, on_error="return").items():
                if isinstance(outcome, BaseException) and not isinstance(outcome, OSError):
                    raise TilencaError(f"worker {address}: {outcome}") from outcome

    def _everywhere(self, function: Callable[..., Any], *arguments: object) -> Iterator[tuple[str, Any]]:
        """What a function returns or raises at the scheduler, which takes tasks apart, and in each worker."""
        try:
            yield f"scheduler {self.scheduler}", self.client.run_on_scheduler(function, *arguments)
        except (ImportError, AttributeError) as error:
            yield f"scheduler {self.scheduler}", error
        for address, result in self.client.run(function, *arguments, on_error="return").items():
            if not isinstance(result, OSError):  # a worker that has just died is Dask's matter
                yield f"worker {address}", result

    def dashboard(self) -> str:
        """Where Dask's dashboard is, or why there is none; of workers on this machine only where it is."""
        try:
            if self._local:
                metadata.version("bokeh")
            else:
                self.client.run_on_scheduler(metadata.version, "bokeh")
        except metadata.PackageNotFoundError:
            if self._local:
                return ""
            return (
                "; no dashboard: bokeh is not installed where the scheduler runs; for one: pip install bokeh"
            )
        return f"; dashboard: {self.client.dashboard_link}"

    def close(self) -> None:
        """Ends the connection, and the workers of its own."""
        for part in (getattr(self, "client", None), self._local):
            if part is not None:
                with suppress(Exception):  # nothing is lost by it any more
                    part.close(timeout=5)


@contextmanager
def open_cluster(scheduler: str | None, jobs: int, check: Check | None = None) -> Iterator[Cluster]:
    """A `Cluster` for the block."""
    cluster = Cluster(scheduler, jobs, check)
    try:
        yield cluster
    finally:
        cluster.close()


def _local_cluster(jobs: int) -> distributed.LocalCluster:
    """Worker processes with one thread each; the operating system chooses all ports."""
    return distributed.LocalCluster(
        n_workers=jobs,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        scheduler_port=0,
        dashboard_address="127.0.0.1:0",
        silence_logs=logging.CRITICAL,
    )


def _address_of(given: str) -> str:
    """The address that was given, or that is in the file that a scheduler writes, which may take a moment.

    Raises:
        ValueError: the file is none of a scheduler, or does not come.
    """
    path, until = Path(given), time.monotonic() + CONNECT_S
    if ":" in given and not path.is_file():
        return given
    while not path.is_file():
        if time.monotonic() > until:
            raise ValueError("neither an address with a port nor the file of a Dask scheduler")
        time.sleep(LOOK_S)
    try:
        return str(read_json(path.read_text(encoding="utf-8"))["address"])
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError("not the file of a Dask scheduler") from error


def _silence() -> None:
    """Dask's log stays quiet: this module says in words what happens."""
    for name in ("distributed", *logging.root.manager.loggerDict):
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL)


def _misfit(who: str, fact: str) -> UsageError:
    return UsageError(
        f"{who}: {fact}; install the same wheel with the same versions on every machine, and start its "
        "scheduler and workers anew"
    )


@contextmanager
def _deaf_to_ctrl_c() -> Iterator[None]:
    """Processes started in this block ignore Ctrl-C in the terminal: their client ends them."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
