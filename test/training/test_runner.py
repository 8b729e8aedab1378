"""One seed or several from start to end, interrupted or not."""

import os
import re
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from support.training import job_of, train
from tilenca.base.errors import InterruptedRunError
from tilenca.training.progress import Progress
from tilenca.training.runner import make_trainer, train_side_by_side
from tilenca.training.runner import train as train_one


@pytest.mark.parametrize("at", [17, 25], ids=["before a measurement", "after one"])
def test_a_resumed_run_ends_in_the_bytes_of_an_uninterrupted_one(
    at: int, two_shapes: Path, trained_model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tilenca.training.runner.TELL_EVERY_S", 0)

    def interrupt(progress: Progress) -> None:
        if progress.iteration == at:
            os.kill(os.getpid(), signal.SIGINT)

    job = job_of([two_shapes], tmp_path)
    with pytest.raises(InterruptedRunError, match=f"at iteration {at + 1}"):
        train_one(job, interrupt)
    assert train(two_shapes, tmp_path, "--resume") == 0
    for name in ("weights.npz", "metrics.json", "history.csv"):
        assert (tmp_path / name).read_bytes() == (trained_model / name).read_bytes(), name
    assert not job.checkpoint.exists()


def test_ctrl_c_ends_seeds_side_by_side_each_with_its_checkpoint(two_shapes: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ["train", "--shapes", two_shapes, "--out", out, "--recipe", "smoke", "--iterations", "1000"]
    process = subprocess.Popen(
        [sys.executable, "-u", "-m", "tilenca.cli", *map(str, words), "--seeds", "2", "--jobs", "2"],
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None
    told: set[str] = set()
    while len(told) < 2 and process.poll() is None:
        line = process.stderr.readline()
        told |= {line[:7]} if line.startswith("seed ") else set()
    os.kill(process.pid, signal.SIGINT)
    _, rest = process.communicate(timeout=60)
    assert process.returncode == 130, rest
    assert "--resume" in rest
    assert sorted(path.name for path in out.glob("*.pt")) == ["checkpoint-1.pt", "checkpoint-2.pt"]


def test_ctrl_c_while_measuring_keeps_what_was_trained(
    two_shapes: Path,
    trained_model: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("tilenca.evaluation.validation.validate", interrupt)
        assert train(two_shapes, tmp_path) == 130
    assert "--resume" in capsys.readouterr().err
    assert train(two_shapes, tmp_path, "--resume") == 0
    assert (tmp_path / "weights.npz").read_bytes() == (trained_model / "weights.npz").read_bytes()


def test_seeds_side_by_side_are_those_trained_alone_and_the_better_one_is_kept(
    two_shapes: Path, trained_model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert train(two_shapes, tmp_path / "both", "--seeds", "2", "--jobs", "2") == 0
    said = capsys.readouterr().err
    assert "seed 5: short of its targets by" in said
    assert "seed 6: short of its targets by" in said
    assert train(two_shapes, tmp_path / "six", "--seed", "6") == 0
    alone = [(trained_model / "weights.npz").read_bytes(), (tmp_path / "six" / "weights.npz").read_bytes()]
    assert (tmp_path / "both" / "weights.npz").read_bytes() in alone
    assert not list((tmp_path / "both").glob("checkpoint*"))


def test_a_failure_in_one_of_the_processes_is_told(two_shapes: Path, tmp_path: Path) -> None:
    jobs = [replace(job_of([two_shapes], tmp_path, seed), resume=True) for seed in (1, 2)]
    for at_once in (1, 2):
        jobs[0].checkpoint.unlink(missing_ok=True)
        jobs[1].checkpoint.write_bytes(b"damaged")
        (failure,) = train_side_by_side(jobs[::-1], at_once, lambda _: None)
        assert re.search(r"seed 2: .*checkpoint-2\.pt: damaged checkpoint", failure)
        assert make_trainer(jobs[0]).done, "the other seed went on to its end"


def test_an_interrupt_while_preparing_ends_at_once(
    two_shapes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupt(*_: object) -> None:
        os.kill(os.getpid(), signal.SIGTERM)
        raise AssertionError("preparing went on after the signal")

    monkeypatch.setattr("tilenca.training.runner.build", interrupt)
    assert train(two_shapes, tmp_path) == 130
    assert "interrupted while training, before the first iteration was done" in capsys.readouterr().err
