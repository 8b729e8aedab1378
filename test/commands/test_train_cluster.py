"""`tilenca train --scheduler`: seeds on a cluster."""

from dataclasses import replace
from pathlib import Path

import pytest

from support.machines import machines
from support.training import SMOKE, job_of, train
from tilenca.commands.train_cluster import train_on_cluster
from tilenca.training.progress import Progress
from tilenca.training.runner import train as train_here
from tilenca.training.trainer import model_of, trained_at

SHORT = replace(SMOKE, iterations=5, check_every=0)


def test_seeds_end_as_here_although_a_worker_dies(two_shapes: Path, tmp_path: Path) -> None:
    there, here = (job_of([two_shapes], tmp_path / name, recipe=SHORT) for name in ("there", "here"))
    seeds = [replace(there, config=replace(there.config, seed=seed)) for seed in (5, 6)]
    for job in (there, here):
        job.out.mkdir()
    told: list[tuple[int, int]] = []

    with machines(tmp_path / "machines", 2) as some:

        def kill(progress: Progress) -> None:
            told.append((progress.seed, progress.iteration))
            if len(told) == 1:
                some.kill(some.workers[0])

        assert train_on_cluster(seeds, some.address, kill, slice_s=0.0) == []
        assert len(told) > 5  # many slices, of both seeds
        assert {seed for seed, _ in told} == {5, 6}
        train_here(here, lambda progress: None)
        ends = [trained_at(job.checkpoint, job.config) for job in (seeds[0], here)]
        assert ends[0].history == ends[1].history
        weights = [model_of(end, {})[0].floats for end in ends]
        assert all((weights[0][name] == weights[1][name]).all() for name in weights[0])


def test_the_command_asks_the_scheduler_that_it_is_given(
    two_shapes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("tilenca.cluster.client.CONNECT_S", 0.2)
    assert train(two_shapes, tmp_path / "model", "--scheduler", "tcp://127.0.0.1:9") == 2
    assert "--scheduler tcp://127.0.0.1:9: no Dask scheduler answers there" in capsys.readouterr().err


def test_a_seed_that_fails_is_a_line_and_has_no_progress(two_shapes: Path, tmp_path: Path) -> None:
    told: list[Progress] = []
    with machines(tmp_path / "machines", 1) as some:
        job = replace(job_of([two_shapes], tmp_path), resume=True)
        job.checkpoint.write_bytes(b"damaged")
        (failure,) = train_on_cluster([job], some.address, told.append)
    assert failure.startswith("seed 5: ")
    assert "damaged checkpoint" in failure
    assert told == []
