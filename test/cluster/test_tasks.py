"""Many tasks on workers that fail, vanish and come."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from support.jobs import defect, full, other_version, refuse, times
from support.machines import in_this_process, machines
from tilenca.base.errors import BuildError, TilencaError, UsageError
from tilenca.cluster import tasks as tasks_module
from tilenca.cluster.client import Cluster, open_cluster
from tilenca.cluster.fingerprint import fingerprint
from tilenca.cluster.tasks import run_tasks


@pytest.fixture(scope="module")
def cluster() -> Iterator[Cluster]:
    """Two workers in this process."""
    with in_this_process(workers=2) as address, open_cluster(address, 1) as ours:
        yield ours


def test_every_task_has_its_result_once(cluster: Cluster) -> None:
    found: list[tuple[int, int]] = []
    run_tasks(cluster, times, 3, range(500), lambda task, result: found.append((task, result)))
    assert sorted(found) == [(task, 3 * task) for task in range(500)]


def test_no_tasks_are_done_at_once(cluster: Cluster) -> None:
    run_tasks(cluster, times, 3, [], lambda *_: pytest.fail("there is no task"))


def test_a_refusal_ends_all_and_names_the_worker(cluster: Cluster) -> None:
    with pytest.raises(BuildError, match=r"^worker tcp://127.0.0.1:\d+: no library$"):
        run_tasks(cluster, refuse, None, range(20), lambda *_: None)


def test_a_refusal_of_a_workers_system_is_a_line(cluster: Cluster) -> None:
    with pytest.raises(TilencaError, match=r"^worker tcp://[^ ]+: \[Errno 28\] No space left on device$"):
        run_tasks(cluster, full, None, [1], lambda *_: None)


def test_a_defect_of_ours_stays_one(cluster: Cluster) -> None:
    with pytest.raises(ZeroDivisionError):
        run_tasks(cluster, defect, None, [1], lambda *_: None)


def test_work_that_ends_early_is_taken_back(cluster: Cluster) -> None:
    def stop(task: int, result: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_tasks(cluster, times, 1, range(300), stop)
    found: list[int] = []
    run_tasks(cluster, times, 1, range(3), lambda task, result: found.append(task))
    assert sorted(found) == [0, 1, 2]


def test_a_worker_that_joins_with_other_software_is_refused(
    cluster: Cluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = replace(fingerprint(), numpy="1.0")
    answers = iter([fingerprint()])  # the client's own first, then those of the worker
    monkeypatch.setattr(tasks_module, "fingerprint", lambda: next(answers, other))
    with pytest.raises(TilencaError, match=r"worker tcp://[^ ]+: has numpy 1\.0 instead of"):
        run_tasks(cluster, times, 1, [1], lambda *_: None)


def test_a_worker_that_joins_after_the_check_is_checked_with_its_first_task(
    cluster: Cluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "check", partial(other_version, "2.0"))  # as if none had been there before
    with pytest.raises(TilencaError, match=r"^worker tcp://[^ ]+: PyTorch 0\.1 instead of 2\.0; install"):
        run_tasks(cluster, times, 1, [1], lambda *_: pytest.fail("it worked"))


def test_one_is_killed_one_joins_late_and_the_scheduler_restarts(tmp_path: Path) -> None:
    found: list[int] = []
    with machines(tmp_path / "logs", 2) as some, open_cluster(some.address, 1) as ours:

        def disturb(task: int, result: int) -> None:
            found.append(result)
            if len(found) == 20:
                some.kill(some.workers[0])
            if len(found) == 120:
                some.add_worker()
                some.kill(some.workers[1])  # now only the late one can go on
            if len(found) == 300:
                some.restart()

        run_tasks(ours, times, 2, range(600), disturb)
        assert [worker.poll() is None for worker in some.workers] == [True]
    assert sorted(found) == [2 * task for task in range(600)]


def test_a_scheduler_that_stays_away_is_a_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tilenca.cluster.client.CONNECT_S", 1.0)
    with machines(tmp_path / "logs", 1) as some:
        ours = Cluster(some.address, 1)
        ours.patience_s = 0.1

        def kill(task: int, result: int) -> None:
            if some.scheduler.poll() is None:
                some.kill(some.scheduler)

        with pytest.raises(
            (TilencaError, UsageError), match=f"the scheduler {some.address} did not come back"
        ):
            run_tasks(ours, times, 2, range(300), kill)
        ours.close()
