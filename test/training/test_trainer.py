"""`tilenca train` from drawings to a model on disk: same seed, same bytes, interrupted or not; refusals."""

import json
import os
import re
import resource
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from tilenca import cli
from tilenca.base import paths
from tilenca.base.errors import InterruptedRunError, TilencaError, UsageError
from tilenca.evaluation.metrics import TARGETS, Target
from tilenca.model.file import Dimensions, load_model
from tilenca.shapes.batch import load_drawings, load_training_task
from tilenca.training.curriculum import Curriculum, labels_of
from tilenca.training.pool import Pools
from tilenca.training.progress import Progress
from tilenca.training.recipes import RECIPES, Recipe
from tilenca.training.runner import HOLDS_TO_END, Job, make_trainer, train_side_by_side
from tilenca.training.runner import train as train_one
from tilenca.training.trainer import Config, Trainer, trained_at

SMOKE = RECIPES["smoke"]
TWO_SHAPES = (
    '[[shape]]\nlabel = "1"\ngrid = """\n#\n#\n#\n"""\n[[shape]]\nlabel = "7"\ngrid = """\n##\n.#\n.#\n"""\n'
)
WRITTEN = ("model.json", "weights.npz", "metrics.json", "history.csv", "README.md")


@pytest.fixture(scope="module")
def shapes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("shapes") / "two.toml"
    path.write_text(TWO_SHAPES)
    return path


@pytest.fixture(scope="module")
def model(shapes: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model trained with seed 5, not interrupted."""
    out = tmp_path_factory.mktemp("models") / "model"
    assert train(shapes, out) == 0
    return out


def train(shapes: Path, out: Path, *more: str) -> int:
    words = [
        "train",
        "--shapes",
        str(shapes),
        "--out",
        str(out),
        "--recipe",
        "smoke",
        "--hidden",
        "12",
        "--seed",
        "5",
        *more,
    ]
    return cli.main(words)


def trainer(seed: int = 1) -> Trainer:
    return make_trainer(job_of([paths.DEFAULT_SHAPES], paths.BUILD, seed))


def job_of(files: list[Path], out: Path, seed: int = 5, hidden: int = 12, recipe: Recipe = SMOKE) -> Job:
    task, sizes = load_training_task(files, recipe.stretch, 20)
    task = replace(task, labels=labels_of(task, recipe, 20))
    config = Config(recipe, Dimensions(21, hidden, hidden), seed, task.labels, task.sources)
    return Job(config, task, sizes, "cpu", out, resume=False)


def test_the_same_seed_gives_the_same_bytes_and_json_names_them(
    shapes: Path, model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = {name: (model / name).read_bytes() for name in WRITTEN}
    assert train(shapes, model, "--force", "--json") == 0
    assert {name: (model / name).read_bytes() for name in WRITTEN} == before
    document = json.loads(capsys.readouterr().out)
    assert document["model"] == str(model)
    assert document["seconds"] > 0
    assert document["metrics"] == json.loads((model / "metrics.json").read_text())


def test_another_seed_gives_another_model() -> None:
    one, two = trainer(seed=1), trainer(seed=2)
    for learner in (one, two):
        learner.step()
    assert not np.array_equal(one.net.arrays()["w3"], two.net.arrays()["w3"])


@pytest.mark.parametrize("at", [17, 25], ids=["before a measurement", "after one"])
def test_a_resumed_run_ends_in_the_bytes_of_an_uninterrupted_one(
    at: int, shapes: Path, model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tilenca.training.runner.TELL_EVERY_S", 0)

    def interrupt(progress: Progress) -> None:
        if progress.iteration == at:
            os.kill(os.getpid(), signal.SIGINT)

    job = job_of([shapes], tmp_path)
    with pytest.raises(InterruptedRunError, match=f"at iteration {at + 1}"):
        train_one(job, interrupt)
    assert train(shapes, tmp_path, "--resume") == 0
    for name in ("weights.npz", "metrics.json", "history.csv"):
        assert (tmp_path / name).read_bytes() == (model / name).read_bytes(), name
    assert not job.checkpoint.exists()


def test_ctrl_c_saves_a_checkpoint_says_how_to_go_on_and_exits_130(shapes: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ["train", "--shapes", shapes, "--out", out, "--recipe", "smoke", "--iterations", "1000"]
    process = subprocess.Popen(
        [sys.executable, "-u", "-m", "tilenca.cli", *map(str, words)], stderr=subprocess.PIPE, text=True
    )
    assert process.stderr is not None
    # The first measurement is told once the signal handler stands.
    first = ""
    while "seed 1:" not in first and process.poll() is None:
        first = process.stderr.readline()
    os.kill(process.pid, signal.SIGINT)
    _, rest = process.communicate(timeout=60)
    assert process.returncode == 130, first + rest
    assert "continue with: tilenca train" in rest
    assert "--resume" in rest
    assert (out / "checkpoint-1.pt").exists()
    assert not (out / "model.json").exists()


def test_ctrl_c_ends_seeds_side_by_side_each_with_its_checkpoint(shapes: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ["train", "--shapes", shapes, "--out", out, "--recipe", "smoke", "--iterations", "1000"]
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
    shapes: Path,
    model: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("tilenca.evaluation.metrics.validate", interrupt)
        assert train(shapes, tmp_path) == 130
    assert "--resume" in capsys.readouterr().err
    assert train(shapes, tmp_path, "--resume") == 0
    assert (tmp_path / "weights.npz").read_bytes() == (model / "weights.npz").read_bytes()


def test_seeds_side_by_side_are_those_trained_alone_and_the_better_one_is_kept(
    shapes: Path, model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert train(shapes, tmp_path / "both", "--seeds", "2", "--jobs", "2") == 0
    said = capsys.readouterr().err
    assert "seed 5: short of its targets by" in said
    assert "seed 6: short of its targets by" in said
    assert train(shapes, tmp_path / "six", "--seed", "6") == 0
    alone = [(model / "weights.npz").read_bytes(), (tmp_path / "six" / "weights.npz").read_bytes()]
    assert (tmp_path / "both" / "weights.npz").read_bytes() in alone
    assert not list((tmp_path / "both").glob("checkpoint*"))


def test_a_failure_in_one_of_the_processes_is_told(shapes: Path, tmp_path: Path) -> None:
    jobs = [replace(job_of([shapes], tmp_path, seed), resume=True) for seed in (1, 2)]
    for at_once in (1, 2):
        jobs[0].checkpoint.unlink(missing_ok=True)
        jobs[1].checkpoint.write_bytes(b"damaged")
        (failure,) = train_side_by_side(jobs[::-1], at_once, lambda _: None)
        assert re.search(r"seed 2: .*checkpoint-2\.pt: damaged checkpoint", failure)
        assert make_trainer(jobs[0]).done, "the other seed went on to its end"


def test_training_ends_early_once_all_targets_held_several_times(
    shapes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tilenca.evaluation.metrics.TARGETS", dict.fromkeys(TARGETS, Target(0.0)))
    recipe = replace(SMOKE, iterations=400, check_every=10)
    trainer = train_one(job_of([shapes], tmp_path, recipe=recipe), lambda _: None)
    assert trainer.ended
    assert trainer.iteration == 10 * HOLDS_TO_END


def test_what_was_measured_best_is_kept(tmp_path: Path) -> None:
    job = job_of([paths.DEFAULT_SHAPES], tmp_path)
    learner = make_trainer(job)
    for shortfall in (0.5, 0.25, 0.75):
        learner.step()
        learner.measured(shortfall, {})
        if shortfall == 0.25:
            wanted = learner.now().weights
    learner.save(job.checkpoint)
    for trained in (learner.best(), trained_at(job.checkpoint, job.config)):
        assert trained.best_iteration == 2
        for name, weights in trained.weights.items():
            assert np.array_equal(weights, wanted[name])
    assert not np.array_equal(learner.now().weights["w3"], wanted["w3"])


def test_a_model_says_how_it_was_made(model: Path) -> None:
    metadata = load_model(model).metadata
    assert (metadata["recipe_name"], metadata["seed"], metadata["recipe"]["iterations"]) == ("smoke", 5, 40)
    assert metadata["sources"][0]["file"] == "two.toml"
    assert load_model(model).labels == ("1", "7", "-"), "tiles learn to say that they do not know"
    card = (model / "README.md").read_text()
    assert metadata["command"] in card
    assert "the tiles' own clocks" in card


def test_two_drawings_are_told_apart_after_a_short_training(shapes: Path) -> None:
    recipe = replace(
        SMOKE, iterations=200, ticks=(8, 12), learning_rate=5e-3, perturbed_pool=0, undisturbed_pool=0
    )
    recipe = replace(recipe, undisturbed_batch=0, refresh_every=0, clocks=0.0)
    recipe = replace(recipe, lossy=0.0, damaged=0.0, unknown=0.0)
    learner = make_trainer(job_of([shapes], paths.BUILD, 1, 16, recipe))
    agreements = [learner.step().agreement for _ in range(200)]
    assert np.mean(agreements[:20]) < 0.6
    assert np.mean(agreements[-50:]) > 0.8


def test_loss_that_is_not_a_number_stops_training() -> None:
    learner = trainer()
    with torch.no_grad():
        next(learner.net.parameters())[0, 0] = torch.nan
    with pytest.raises(TilencaError, match=r"loss is nan at iteration 1.*--seed"):
        learner.step()


@pytest.mark.skipif(not torch.cuda.is_available(), reason="PyTorch finds no CUDA device here")
def test_a_gpu_trains_the_same_but_for_rounding(tmp_path: Path) -> None:
    job = job_of([paths.DEFAULT_SHAPES], tmp_path)
    learners = [make_trainer(replace(job, device=device)) for device in ("cpu", "cuda")]
    for _ in range(3):
        losses = [learner.step().loss for learner in learners]
        assert losses[1] == pytest.approx(losses[0], rel=1e-3)


def test_pools_hold_states_of_their_drawings_only() -> None:
    learner = trainer()
    for _ in range(30):
        learner.step()
    for pool in (learner.pools.perturbed, learner.pools.undisturbed):
        sizes = learner.drawings.sizes[pool.drawing]
        for states, size in zip(pool.states, sizes, strict=True):
            assert not states[size:].any()
        assert np.abs(pool.states).max() <= 127 / 64


def test_rebuilt_tissues_keep_the_states_of_tiles_that_stay() -> None:
    drawings = load_drawings([paths.DEFAULT_SHAPES])
    even = Curriculum(drawings, np.full(len(drawings), 1 / len(drawings)), np.ones(len(drawings), np.bool_))
    pools = Pools(SMOKE, even, 21, np.random.default_rng(1))
    four, nine = 4, 9  # every tile of the "4" is a tile of the "9"
    kept, all_of_nine = int(drawings.sizes[four]), int(drawings.sizes[nine])
    for _ in range(200):
        pools.perturbed.drawing[0] = four
        pools.perturbed.states[0] = 0
        pools.perturbed.states[0, :kept, 3] = 0.25
        pools.switch(pools.perturbed, 0)
        if pools.perturbed.drawing[0] == nine:
            break
    assert pools.perturbed.drawing[0] == nine
    assert (pools.perturbed.states[0, :all_of_nine, 3] == 0.25).sum() == kept
    assert (pools.perturbed.states[0, :all_of_nine, 0] == 1.0).sum() == all_of_nine - kept
    assert not pools.perturbed.states[0, all_of_nine:].any()


Refusal = Callable[[Path, Path], list[str]]
REFUSALS: list[tuple[str, Refusal]] = [
    ("holds a model already", lambda shapes, full: ["--shapes", str(shapes), "--out", str(full)]),
    (
        "no checkpoint of this run to resume",
        lambda shapes, full: ["--shapes", str(shapes), "--out", str(full), "--resume"],
    ),
    ("no recipe 'fast'", lambda shapes, full: ["--shapes", str(shapes), "--out", "x", "--recipe", "fast"]),
    ("room for 1;", lambda shapes, full: ["--shapes", str(shapes), "--out", "x", "--state", "2"]),
    ("--device tpu", lambda shapes, full: ["--shapes", str(shapes), "--out", "x", "--device", "tpu"]),
]


@pytest.mark.parametrize(("message", "words"), REFUSALS, ids=[message for message, _ in REFUSALS])
def test_what_cannot_be_done_is_refused_in_one_line(
    message: str,
    words: Refusal,
    shapes: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    full = tmp_path / "full"
    full.mkdir()
    (full / "model.json").write_text("{}")
    assert cli.main(["train", *words(shapes, full)]) == 2
    error = capsys.readouterr().err.strip()
    assert message in error
    assert len(error.splitlines()) == 1
    assert (full / "model.json").read_text() == "{}"


def test_a_checkpoint_of_another_configuration_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.pt"
    trainer(seed=1).save(path)
    with pytest.raises(UsageError, match="made with another seed"):
        trainer(seed=2).load(path)


def test_a_damaged_checkpoint_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.pt"
    trainer().save(path)
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(UsageError, match="damaged checkpoint"):
        trainer().load(path)


@pytest.mark.parametrize(
    "words",
    [
        ["--state", "1"],
        ["--hidden", "128"],
        ["--iterations", "0"],
        ["--validation-runs", "x"],
        ["--seed", "-1"],
    ],
)
def test_values_that_make_no_sense_are_refused(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit, match="2"):
        cli.main(["train", "--out", str(tmp_path / "out"), *words])
    error = capsys.readouterr().err.strip()
    assert words[0] in error
    assert len(error.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def drawing(label: str, *rows: str) -> str:
    return f'[[shape]]\nlabel = "{label}"\ngrid = """\n' + "\n".join(rows) + '\n"""\n'


ODD_FILES = {
    "one class": drawing("1", "#", "#", "#"),
    "one tile and a ring": drawing("o", "#") + drawing("0", "#####", "#...#", "#...#", "#...#", "#####"),
    "only single tiles": drawing("1", "#"),
    "a drawing far from the other": drawing("L", "#....", "#....", "#....", "#....", "#####")
    + drawing("1", "##"),
    "a dash of its own": drawing("1", "#", "#", "#")
    + drawing("-", "##", "##")
    + drawing("7", "##", ".#", ".#"),
    "sizes": '[sizes]\nfrom = "3x2"\nto = "4x3"\nheld_out = ["4x2"]\n'
    + drawing("7", "##", ".#", ".#")
    + drawing("L", "#.", "#.", "##"),
}


@pytest.mark.parametrize("content", ODD_FILES.values(), ids=list(ODD_FILES))
def test_odd_shape_files_are_trained_and_examined(
    content: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "odd.toml"
    file.write_text(content)
    assert train(file, tmp_path / "out", "--iterations", "20") == 0
    words = ["evaluate", "--suite", "--model", str(tmp_path / "out"), "--shapes", str(file), "--runs", "2"]
    trained = json.loads((tmp_path / "out" / "metrics.json").read_text())
    capsys.readouterr()
    assert cli.main([*words, "--seed", str(trained["seed"]), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["metrics"]["rows"] == trained["rows"]


def test_as_many_classes_as_a_wide_state_has_room_for(tmp_path: Path) -> None:
    labels = "0123456789AbCcdEFGHhIJKLMnoPqrtUuVWXY_="
    rows = [format(number + 64, "b").replace("0", ".").replace("1", "#") for number in range(64)]
    file = tmp_path / "many.toml"
    file.write_text(
        "".join(drawing(label, row, "#" * len(row)) for label, row in zip(labels, rows, strict=False))
    )
    assert train(file, tmp_path / "out", "--iterations", "4", "--state", "51") == 0
    assert len(load_model(tmp_path / "out").labels) == len(labels) + 1


def test_sizes_at_which_two_classes_are_one_drawing_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "alike.toml"
    sizes = '[sizes]\nfrom = "3x3"\nto = "6x6"\n'
    file.write_text(
        sizes + drawing("1", "###", "#..", "#..") + drawing("7", "###", "#..", "#..", "#..", "#..")
    )
    assert train(file, tmp_path / "out") == 2
    assert "'1' and '7' are the same drawing at" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@contextmanager
def files_end_at(size: int) -> Iterator[None]:
    """No file of this process grows beyond `size` bytes, as on a disk that is nearly full."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_disk_that_fills_up_leaves_the_checkpoint_before_and_no_half_one(tmp_path: Path) -> None:
    path, learner = tmp_path / "checkpoint-1.pt", trainer()
    learner.save(path)
    before = path.read_bytes()
    learner.step()
    with files_end_at(len(before) // 2), pytest.raises(TilencaError, match="File too large"):
        learner.save(path)
    assert path.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["checkpoint-1.pt"]


def test_a_full_disk_ends_training_with_one_line(
    shapes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    # A device on which there is never room, where the checkpoint is written before it is renamed.
    (out / "checkpoint-5.part").symlink_to("/dev/full")
    assert train(shapes, out, "--iterations", "4") == 1
    said = capsys.readouterr()
    assert said.out == ""
    full = f"seed 5: {out}/checkpoint-5.pt: No space left on device; make room there, or give another --out"
    assert said.err.splitlines().count(full) == 1
    assert "Traceback" not in said.err
    assert list(out.iterdir()) == []
