"""Runs the training of one seed, from start or checkpoint to end, or of several seeds side by side."""

import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from pathlib import Path

import numpy as np
import torch

from tilenca.base.errors import InterruptedRunError, TilencaError
from tilenca.base.signals import SIGNALS, deaf_to_ctrl_c, promising
from tilenca.evaluation.evaluator import Evaluator
from tilenca.evaluation.metrics import least_shares
from tilenca.evaluation.suites import Suite, make_suite
from tilenca.evaluation.workload import rows_during_training
from tilenca.model.file import checkpoint_path
from tilenca.shapes.batch import Drawings
from tilenca.shapes.sizes import Sizes
from tilenca.shapes.variant import CHOOSING
from tilenca.simulator.engine import FastEngine
from tilenca.training.config import Config
from tilenca.training.curriculum import build
from tilenca.training.progress import Progress, Tell
from tilenca.training.recipe import aims_of
from tilenca.training.rollout import use_threads
from tilenca.training.trainer import Trained, Trainer, model_of

CHECKPOINT_EVERY_S = 45.0
TELL_EVERY_S = 0.2
CHECK_RUNS = 10  # of each drawing in the measurements during training
CLOSER_RUNS = 40  # of each drawing where all targets held with fewer
HOLDS_TO_END = 3  # measurements in a row in which all targets must hold, to end early
ENDING = (signal.SIGINT, *SIGNALS)
SAVING = (
    "keeps a checkpoint once this iteration, or a measurement after it, is done; Ctrl-C again ends without"
)
WITHOUT = "ends without another checkpoint, as soon as the step at work is done"


@dataclass(frozen=True)
class Job:
    """The task of one process.

    Attributes:
        config: of the run; its labels are those of the curriculum.
        task: the drawings of the files.
        sizes: of the task.
        device: of the tensors, `cpu` or `cuda`.
        out: the folder of the checkpoints.
        resume: whether to go on from a checkpoint.
        threads: how many processors it may use; the result does not depend on it.
    """

    config: Config
    task: Drawings
    sizes: Sizes
    device: str
    out: Path
    resume: bool
    threads: int = 1

    @property
    def checkpoint(self) -> Path:
        """The file that a run resumes from."""
        return checkpoint_path(self.out, self.config.seed)


def make_trainer(job: Job) -> Trainer:
    """The trainer of a job, at its beginning or at its checkpoint."""
    use_threads(job.threads)
    config = job.config
    curriculum = build(job.task, config.recipe, job.sizes, np.random.default_rng(config.seed))
    trainer = Trainer(config, curriculum, torch.device(job.device))
    if job.resume and job.checkpoint.exists():
        trainer.load(job.checkpoint)
    return trainer


def train(job: Job, tell: Tell) -> Trained:
    """Trains to the end.

    Raises:
        InterruptedRunError: Ctrl-C; everything done so far is in the checkpoint.
        TilencaError: training diverged, or the checkpoint is of no use.
    """
    prepared = prepare(job)  # an interrupt ends this at once: there is nothing new to keep
    with _interruptible() as interrupted:
        return _advance(job, *prepared, tell, interrupted)


def prepare(job: Job) -> tuple[Trainer, Suite | None]:
    """The trainer, and what it is measured with while it trains; for large drawings it takes a while.

    Raises:
        TilencaError: the checkpoint is of no use.
    """
    return make_trainer(job), _suite(job) if job.config.recipe.check_every else None


def advance(job: Job, tell: Tell, interrupted: Callable[[], bool]) -> Trained:
    """Trains to the end, or until it is interrupted; from any thread.

    Args:
        job: the task.
        tell: called with the progress now and then.
        interrupted: asked after every iteration.

    Raises:
        InterruptedRunError: it was interrupted; everything done so far is in the checkpoint.
        TilencaError: training diverged, or the checkpoint is of no use.
    """
    return _advance(job, *prepare(job), tell, interrupted)


def _advance(
    job: Job, trainer: Trainer, suite: Suite | None, tell: Tell, interrupted: Callable[[], bool]
) -> Trained:
    recipe, saved, told = job.config.recipe, time.monotonic(), 0.0
    check: tuple[int, int, float] | None = None

    def report(rows: tuple[int, int] | None = None) -> None:
        tell(Progress(job.config.seed, trainer.iteration, *trainer.recent(), check, rows))

    while not trainer.done:
        trainer.step()
        if suite is not None and (trainer.iteration % recipe.check_every == 0 or trainer.done):
            check = _check(trainer, suite, report)
        stop = interrupted()
        if stop or time.monotonic() - saved > CHECKPOINT_EVERY_S:
            trainer.save(job.checkpoint)
            saved = time.monotonic()
        if stop or trainer.done or time.monotonic() - told > TELL_EVERY_S:
            report()
            told = time.monotonic()
        if stop:
            raise InterruptedRunError(f"at iteration {trainer.iteration}")
    trainer.save(job.checkpoint)  # measuring takes a while, and Ctrl-C can interrupt it too
    return trainer.best()


def _suite(job: Job) -> Suite:
    """What a job is measured with while it trains; making it takes seconds."""
    aims = aims_of(job.config.recipe)
    return make_suite(job.task, job.sizes, job.config.labels, aims, job.config.seed, CHOOSING)


def _check(trainer: Trainer, suite: Suite, tell: Callable[[tuple[int, int]], None]) -> tuple[int, int, float]:
    """A short measurement; ends the training when all targets held several times in a row."""
    model, _ = model_of(trainer.now(), {})
    count = rows_during_training(FastEngine(model), suite)
    for runs in (CHECK_RUNS, CLOSER_RUNS):
        rows = []
        tell((0, count))
        for row in Evaluator(FastEngine(model), suite, runs, trainer.config.seed + runs).short_rows():
            rows.append(row)
            tell((len(rows), count))
        if shortfall := sum(row.shortfall for row in rows):
            break
    trainer.measured(shortfall, least_shares(rows))
    last = [short for _, short, _ in trainer.checks[-HOLDS_TO_END:]]
    trainer.ended = len(last) == HOLDS_TO_END and not any(last)
    aimed = [row for row in rows if row.target is not None]
    return sum(row.holds for row in aimed), len(aimed), shortfall


def train_side_by_side(jobs: Sequence[Job], at_once: int, tell: Tell) -> list[str]:
    """Trains every job, `at_once` of them in processes of their own; each writes a last checkpoint.

    Returns:
        One line for each run that failed; the others ran to their end.

    Raises:
        InterruptedRunError: Ctrl-C; every run that had begun has its checkpoint.
    """
    if at_once == 1 or len(jobs) == 1:
        return _train_in_turn(jobs, tell)
    waiting, processes = list(jobs), _Processes(tell)
    with _interruptible() as interrupted:
        while waiting or processes.running:
            while waiting and len(processes.running) < at_once and not interrupted():
                processes.start(waiting.pop(0))
            processes.listen(interrupted)
            if interrupted():
                waiting.clear()
                processes.stop()
        if interrupted():
            raise InterruptedRunError("while training")
    return processes.failures


def _train_in_turn(jobs: Sequence[Job], tell: Tell) -> list[str]:
    """Trains one job after the other in this process; returns a line for each that failed."""
    failures = []
    for job in jobs:
        try:
            train(job, tell)
        except InterruptedRunError:
            raise
        except (TilencaError, OSError) as error:
            failures.append(_failure(job, error))
    return failures


def _failure(job: Job, error: Exception) -> str:
    return f"seed {job.config.seed}: {error}"


class _Processes:
    """Processes that train one job each and report through a connection.

    Attributes:
        running: the processes, by the connection that each reports through.
        failures: one line for each that failed.
    """

    def __init__(self, tell: Tell) -> None:
        self.running: dict[Connection, SpawnProcess] = {}
        self.failures: list[str] = []
        self._tell = tell
        self._context = multiprocessing.get_context("spawn")

    def start(self, job: Job) -> None:
        """Starts the process of a job."""
        ours, theirs = self._context.Pipe(duplex=False)
        process = self._context.Process(target=_in_process, args=(job, theirs), daemon=True)
        with deaf_to_ctrl_c():  # until it can save its work, the parent stops it
            process.start()
        theirs.close()
        self.running[ours] = process

    def listen(self, interrupted: Callable[[], bool]) -> None:
        """Waits half a second for reports, passes progress on, and notes failures and ends.

        Args:
            interrupted: whether the processes were stopped; then it is no failure that one ends early.
        """
        for connection in wait(list(self.running), timeout=0.5):
            assert isinstance(connection, Connection)
            try:
                report = connection.recv()
            except EOFError:
                process = self.running.pop(connection)
                process.join()
                if process.exitcode and not interrupted():
                    self.failures.append(f"a training process ended with {process.exitcode}")
                continue
            if isinstance(report, Progress):
                self._tell(report)
            else:
                self.failures.append(report)

    def stop(self) -> None:
        """Lets every process save a checkpoint and end."""
        for process in self.running.values():
            if process.pid is not None and process.is_alive():
                os.kill(process.pid, signal.SIGTERM)


def _in_process(job: Job, connection: Connection) -> None:
    """The body of a process: it sends its progress and a failure's text through the connection."""
    try:
        train(job, connection.send)
    except InterruptedRunError:
        pass
    except (TilencaError, OSError) as error:
        connection.send(_failure(job, error))
    finally:
        connection.close()


@contextmanager
def _interruptible() -> Iterator[Callable[[], bool]]:
    """Ctrl-C waits for the end of the step, so that the checkpoint is whole; a second one does not wait."""
    caught: list[int] = []

    def note(number: int, _frame: object) -> None:
        caught.append(number)
        if number == signal.SIGINT:
            signal.signal(number, signal.default_int_handler)

    # Signals that the parent process ignores (nohup) stay ignored, except Ctrl-C.
    heeded = [n for n in ENDING if n == signal.SIGINT or signal.getsignal(n) is not signal.SIG_IGN]
    before = {number: signal.signal(number, note) for number in heeded}
    try:
        with promising(SAVING, WITHOUT):
            yield lambda: bool(caught)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
