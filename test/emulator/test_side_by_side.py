"""Several emulations at once: results in their order, and one failure ends all."""

import threading

import pytest

from tilenca.base.processors import processors
from tilenca.emulator.side_by_side import at_once, run_side_by_side, threads_of_each

LIMIT_S = 30


def test_results_come_in_the_order_of_the_jobs_whoever_ends_first() -> None:
    second_ended = threading.Event()

    def run(job: int, stopped: threading.Event) -> int:
        if job == 1:
            second_ended.set()
        return 10 * job

    assert list(run_side_by_side(run, [0, 1, 2, 3])) == [(0, 0), (1, 10), (2, 20), (3, 30)]
    assert second_ended.is_set()


@pytest.mark.parametrize("jobs", [0, 1, 2, 3, 100])
def test_jobs_and_their_threads_use_all_processors_and_no_more(jobs: int) -> None:
    assert 1 <= at_once(jobs) <= max(1, jobs)
    assert threads_of_each(jobs) >= 1
    assert at_once(jobs) * threads_of_each(jobs) <= processors()
    if jobs in (1, 100):
        assert at_once(jobs) * threads_of_each(jobs) == processors()


def test_no_job_is_no_work() -> None:
    assert list(run_side_by_side(lambda job, stopped: job, [])) == []


def test_a_failure_stops_those_that_run_and_those_that_wait() -> None:
    begun: list[int] = []

    def run(job: int, stopped: threading.Event) -> int:
        begun.append(job)
        if job == 0:
            raise ValueError("job 0 fails")
        assert stopped.wait(LIMIT_S), "nobody said that the others were stopped"
        raise InterruptedError

    with pytest.raises(ValueError, match="job 0 fails"):
        list(run_side_by_side(run, range(20)))
    assert len(begun) <= 2 * processors(), "none of the rest is begun"


def test_who_stops_listening_stops_the_work() -> None:
    told: list[threading.Event] = []

    def run(job: int, stopped: threading.Event) -> int:
        told.append(stopped)
        return job

    results = run_side_by_side(run, range(20))
    assert next(results) == (0, 0)
    results.close()  # type: ignore[attr-defined]
    assert told[0].is_set()
