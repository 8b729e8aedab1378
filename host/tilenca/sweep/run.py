"""Runs a sweep on a cluster, from its journal to its end."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from tilenca.cluster.client import Cluster
from tilenca.cluster.tasks import run_tasks
from tilenca.sweep.journal import Journal
from tilenca.sweep.measure import Measured, measure_blocks
from tilenca.sweep.plan import Plan
from tilenca.sweep.rows import Block, tasks_of

MOST_S, LEAST_S = 2.0, 0.2  # of a task
TASKS_PER_THREAD = 8  # at least, so that no worker waits long for the last ones
THREAD_S = 0.002  # a task is longer by this for each thread: twice what a scheduler takes for a task


@dataclass
class Progress:
    """How far a sweep is.

    Attributes:
        runs: all.
        done: finished.
        before: of them, those that the journal had.
        updates: cell updates of this session.
        cpu_s: seconds of processor time of the workers in this session.
    """

    runs: int
    done: int
    before: int
    updates: int = 0
    cpu_s: float = 0.0


def run_sweep(plan: Plan, journal: Journal, cluster: Cluster, tell: Callable[[Progress], Any]) -> Progress:
    """Runs what the journal does not have yet.

    Args:
        plan: of the sweep.
        journal: results go there as they come.
        cluster: where to run.
        tell: called after every result, and now and then.

    Raises:
        TilencaError: a worker cannot do the work.
    """
    progress, missing = progress_of(plan, journal)
    tell(progress)

    def take(_: list[Block], measured: Measured) -> None:
        journal.add(measured.counts)
        progress.done += sum(counts.runs for counts in measured.counts.values())
        progress.updates += sum(counts.updates for counts in measured.counts.values())
        progress.cpu_s += measured.cpu_s
        tell(progress)

    if missing:
        tasks = tasks_of(missing, task_seconds(sum(block.cost_s for block in missing), cluster.threads()))
        run_tasks(cluster, measure_blocks, plan.luggage, tasks, take, lambda: tell(progress))
    return progress


def task_seconds(work_s: float, threads: int) -> float:
    """How long a task is to be: long against the scheduler's part of it, short against the whole work.

    Args:
        work_s: seconds of all tasks together.
        threads: of all workers.
    """
    fair_s = work_s / (TASKS_PER_THREAD * max(threads, 1))
    return min(max(LEAST_S, fair_s), max(MOST_S, THREAD_S * threads))


def progress_of(plan: Plan, journal: Journal) -> tuple[Progress, list[Block]]:
    """How far the journal is, and the blocks that it lacks."""
    blocks = [block for row in plan.rows for block in row.blocks()]
    missing = [block for block in blocks if block.key not in journal.counts]
    runs = sum(block.runs for block in blocks)
    done = runs - sum(block.runs for block in missing)
    return Progress(runs, done, done), missing
