"""A training from its plan to the files of a model, seen through a view of its own."""

import argparse
import json
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest

from tilenca.base.errors import InterruptedRunError
from tilenca.commands import train
from tilenca.commands.train_plan import make_plan
from tilenca.commands.train_steps import at_once, jobs_of, train_model, training_command
from tilenca.model.file import load_model
from tilenca.training.progress import Progress, Tell
from tilenca.views.training import TrainingViews


def arguments(shapes: Path, out: Path, *more: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    train.add_arguments(parser)
    words = ["--shapes", str(shapes), "--out", str(out), "--recipe", "smoke", "--hidden", "12", *more]
    return parser.parse_args(words)


def test_a_view_hears_of_every_seed_and_every_row(two_shapes: Path, tmp_path: Path) -> None:
    heard: list[Progress] = []
    rows: list[str] = []
    counts: list[int] = []

    @contextmanager
    def training(seeds: Sequence[int], total: int) -> Iterator[Tell]:
        assert (tuple(seeds), total) == ((3, 4), 12)
        yield heard.append

    @contextmanager
    def measuring(where: str, count: int) -> Iterator[Callable[[str], None]]:
        assert where == str(tmp_path / "README.md")
        counts.append(count)
        yield rows.append

    args = arguments(two_shapes, tmp_path, "--seed", "3", "--seeds", "2", "--jobs", "1", "--iterations", "12")
    made = train_model(args, make_plan(args), TrainingViews(training, measuring), "")
    assert made.folder == tmp_path
    assert {one.seed for one in heard} == {3, 4}
    assert heard[-1].iteration == 12
    assert [len(rows)] == counts == [len(made.metrics["rows"])]
    short = [one.rows for one in heard if one.rows is not None and one.seed == 3]
    assert short[0] == (0, short[0][1])
    assert short[-1] == (short[0][1], short[0][1]), "all rows of the measurement at the end"
    assert load_model(tmp_path).model_id == made.model.model_id
    assert json.loads((tmp_path / "metrics.json").read_text()) == made.metrics
    assert (tmp_path / "history.png").exists()
    assert not list(tmp_path.glob("*.pt"))


def test_after_an_interrupt_the_caller_says_how_to_go_on(two_shapes: Path, tmp_path: Path) -> None:
    told: list[Progress] = []

    def interrupt(news: Progress) -> None:
        told.append(news)
        if len(told) == 1:
            os.kill(os.getpid(), signal.SIGINT)

    @contextmanager
    def training(seeds: Sequence[int], total: int) -> Iterator[Tell]:
        yield interrupt

    args = arguments(two_shapes, tmp_path, "--iterations", "1000")
    with pytest.raises(InterruptedRunError, match=r"interrupted at iteration \d+; do it again"):
        train_model(args, make_plan(args), TrainingViews(training), "do it again")
    assert (tmp_path / "checkpoint-1.pt").exists()


def test_a_seed_that_cannot_go_on_is_not_lost(
    two_shapes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    damaged, other = tmp_path / "checkpoint-2.pt", tmp_path / "checkpoint-9.pt"
    damaged.write_bytes(b"half of it")
    other.write_bytes(b"of a seed that is not asked for")
    words = ("--iterations", "4", "--jobs", "1", "--resume")
    args = arguments(two_shapes, tmp_path, *words, "--seeds", "2")
    assert train_model(args, make_plan(args), TrainingViews(), "").folder == tmp_path
    said = capsys.readouterr().err
    assert f"seed 2: {damaged}: damaged checkpoint" in said
    assert f"note: {tmp_path}: the checkpoints of all seeds stay; --resume goes on with them" in said
    assert damaged.read_bytes() == b"half of it"
    assert (tmp_path / "checkpoint-1.pt").exists()
    args = arguments(two_shapes, tmp_path, *words)
    train_model(args, make_plan(args), TrainingViews(), "")
    assert {path.name for path in tmp_path.glob("*.pt")} == {damaged.name, other.name}


def test_seeds_share_the_processors_and_a_worker_has_one(two_shapes: Path, tmp_path: Path) -> None:
    args = arguments(two_shapes, tmp_path, "--seeds", "2", "--jobs", "2")
    plan = make_plan(args)
    assert at_once(args, plan) == 2
    assert [job.config.seed for job in jobs_of(args, plan)] == [1, 2]
    args = arguments(two_shapes, tmp_path, "--seeds", "2", "--scheduler", "tcp://nowhere:1")
    assert [job.threads for job in jobs_of(args, plan)] == [1, 1]


def test_the_command_of_a_model_has_what_decides_it_and_nothing_else(
    two_shapes: Path, tmp_path: Path
) -> None:
    more = ("--state", "24", "--jobs", "3", "--force", "--learning-rate", "2e-4")
    args = arguments(two_shapes, tmp_path, *more)
    words = training_command(args, str).split()
    assert words[:6] == ["tilenca", "train", "--shapes", str(two_shapes), "--out", str(tmp_path)]
    assert words[6:] == [
        *("--recipe", "smoke", "--seed", "1", "--seeds", "1", "--iterations", "40", "--hidden", "12"),
        *("--learning-rate", "0.0002", "--state", "24"),
    ]


def test_the_command_of_a_wider_model_has_the_widths_and_the_weights(
    two_shapes: Path, tmp_path: Path
) -> None:
    args = arguments(two_shapes, tmp_path, "--weights", "digits-40", "--state", "24")
    assert training_command(args).split()[-6:] == [
        *("--weights", "models/digits-40", "--hidden", "12", "--state", "24")
    ]
    args.hidden = args.state = None
    assert training_command(args).split()[-2:] == ["--weights", "models/digits-40"]
