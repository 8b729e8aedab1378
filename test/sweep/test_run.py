"""A sweep on real workers: the same bytes whatever happens to them."""

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from support.machines import Machines, machines
from support.sweeps import plan
from tilenca.cluster.client import open_cluster
from tilenca.sweep.journal import Journal
from tilenca.sweep.measure import measure_blocks
from tilenca.sweep.run import Progress, run_sweep, task_seconds
from tilenca.sweep.table import rows_of, write_parquet

SWEEP = plan("loss=0:0.4:0.2", "size=drawn,7x6", runs=40)


def table_of(folder: Path, journal: Journal) -> bytes:
    rows = rows_of(SWEEP, journal.counts, lambda row, whole: "again")
    return write_parquet(folder, rows, {}).read_bytes()


def run(folder: Path, some: Machines, disturb: Callable[[Progress], None]) -> tuple[bytes, Progress]:
    """The table, and how far the last session came."""
    with closing(Journal(folder, SWEEP.identity, "")) as journal, open_cluster(some.address, 1) as cluster:
        progress = run_sweep(SWEEP, journal, cluster, disturb)
        return table_of(folder, journal), progress


def alone(folder: Path) -> bytes:
    """The table, measured in this process, block after block."""
    with closing(Journal(folder, SWEEP.identity, "")) as journal:
        for row in SWEEP.rows:
            journal.add(measure_blocks(SWEEP.luggage, list(row.blocks())).counts)
        return table_of(folder, journal)


def test_one_worker_two_and_two_with_one_killed_give_the_same_bytes(tmp_path: Path) -> None:
    expected = alone(tmp_path / "alone")
    killed_at: list[int] = []
    with machines(tmp_path / "machines", 1) as some:
        assert run(tmp_path / "one", some, lambda progress: None)[0] == expected
        some.add_worker()
        assert run(tmp_path / "two", some, lambda progress: None)[0] == expected

        def kill(progress: Progress) -> None:
            if progress.done and not killed_at:
                killed_at.append(progress.done)
                some.kill(some.workers[0])

        table, progress = run(tmp_path / "killed", some, kill)
    assert table == expected
    assert 0 < killed_at[0] < progress.done == progress.runs == 6 * 10 * 40


def test_a_scheduler_that_restarts_and_late_workers_change_no_byte(tmp_path: Path) -> None:
    restarted: list[int] = []
    with machines(tmp_path / "machines", 2) as some:

        def restart(progress: Progress) -> None:
            if progress.done and not restarted:
                restarted.append(progress.done)
                some.restart()

        table, progress = run(tmp_path / "restarted", some, restart)
    assert table == alone(tmp_path / "alone")
    assert 0 < restarted[0] < progress.runs


@pytest.mark.parametrize(
    ("work_s", "threads", "seconds"),
    [
        (1.0, 2, 0.2),
        (100.0, 2, 2.0),
        (16.0, 2, 1.0),
        (1e7, 10_000, 20.0),
        (1e5, 10_000, 1.25),
        (5.0, 0, 0.625),
    ],
)
def test_tasks_are_long_for_the_scheduler_and_short_for_the_whole(
    work_s: float, threads: int, seconds: float
) -> None:
    assert task_seconds(work_s, threads) == pytest.approx(seconds)
