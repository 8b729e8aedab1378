"""A checkpoint is whole or not at all, and of this run or refused."""

import copy
import io
import resource
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import torch
from hypothesis import example, given, settings
from hypothesis import strategies as st

from support.refusal import read_or_refused
from support.strategies import damaged
from support.training import SMOKE, job_of, trainer
from tilenca.base import paths
from tilenca.base.errors import TilencaError, UsageError
from tilenca.training.checkpoint import glance, refuse_other
from tilenca.training.runner import make_trainer
from tilenca.training.trainer import Trainer, trained_at


def test_a_checkpoint_of_another_configuration_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.pt"
    trainer(seed=1).save(path)
    with pytest.raises(UsageError, match="--seed 2, the checkpoint has 1; give the arguments of the run"):
        trainer(seed=2).load(path)


def test_what_differs_is_told_by_the_option_and_both_values() -> None:
    theirs = trainer(seed=1).config.as_json()
    ours = copy.deepcopy(theirs)
    refuse_other(Path("c.pt"), theirs, ours)
    ours["recipe"] |= {"iterations": 1000, "clip_norm": 9.0}
    ours["dimensions"]["hidden1"] = 32
    ours["labels"] = ["L", "t"]
    with pytest.raises(UsageError) as refused:
        refuse_other(Path("c.pt"), theirs, ours)
    was, labels = theirs["recipe"]["iterations"], " ".join(theirs["labels"])
    assert str(refused.value).startswith(
        f"c.pt: --iterations 1000, the checkpoint has {was}; --hidden 32, the checkpoint has "
        f"{theirs['dimensions']['hidden1']}; another --recipe; the labels L t, "
        f"the checkpoint has {labels}; give"
    )
    with pytest.raises(UsageError, match="--iterations 1000, the checkpoint has None"):
        refuse_other(Path("c.pt"), {"recipe": 3}, ours)


class Run:
    """A training with a measured result, and its checkpoint; Hypothesis does not print the bytes."""

    def __init__(self, learner: Trainer, whole: bytes) -> None:
        self.learner, self.whole = learner, whole


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    path, learner = tmp_path_factory.mktemp("whole") / "checkpoint.pt", trainer()
    learner.step()
    learner.measured(0.5, {"right": 0.5})
    learner.save(path)
    return Run(learner, path.read_bytes())


def state_of(data: bytes) -> Any:
    return torch.load(io.BytesIO(data), weights_only=True)


def readings(path: Path, content: bytes, learner: Trainer) -> list[int | None]:
    """The iteration that each reader of a checkpoint finds in these bytes; None where it refuses them."""

    def loaded(path: Path) -> int:
        learner.load(path)
        return learner.iteration

    readers: list[Callable[[Path], int]] = [
        loaded,
        lambda path: trained_at(path, learner.config).iteration,
        lambda path: int(glance(path)["iteration"]),
    ]
    return [read_or_refused(path, content, read) for read in readers]


@settings(max_examples=60)
@given(st.data())
def test_any_bytes_are_the_checkpoint_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, run: Run, data: st.DataObject
) -> None:
    path, before = tmp_path_factory.mktemp("fuzz") / "checkpoint-1.pt", state_of(run.whole)["ema"]
    assert set(readings(path, data.draw(damaged(run.whole)), run.learner)) <= {None, 1}
    assert all(torch.equal(run.learner.ema[name], value) for name, value in before.items())


PLACES = [
    *(
        ("config",),
        ("iteration",),
        ("ended",),
        ("done",),
        ("random",),
        ("random", "state"),
        ("net",),
        ("net", "w1"),
    ),
    *(("ema",), ("ema", "b2"), ("best",), ("best", 0), ("best", 2), ("best", 2, "w3"), ("optimizer",)),
    *(("optimizer", "param_groups"), ("pools",), ("pools", "failures"), ("pools", "perturbed", "states")),
    *(
        ("pools", "undisturbed"),
        ("history",),
        ("since",),
        ("history", 0),
        ("checks",),
        ("checks", 0),
        ("checks", 0, 2),
    ),
]
FOREIGN = [None, 1, "x", [], {}, [1], {"right": "x"}, torch.zeros(3), torch.zeros((2, 3), dtype=torch.int64)]


def replaced(value: Any, place: tuple[Any, ...], other: Any) -> Any:
    """The value with another one at a place in it."""
    if not place:
        return other
    key, *rest = place
    inner = replaced(value[key], tuple(rest), other)
    if isinstance(value, dict):
        return {**value, key: inner}
    return type(value)([*value[:key], inner, *value[key + 1 :]])


@settings(max_examples=60)
@given(st.sampled_from([(), *PLACES]), st.sampled_from(FOREIGN))
@example(("config",), [])
@example((), torch.zeros(3))
@example(("pools", "failures"), torch.zeros(3))
def test_a_checkpoint_with_another_value_in_it_is_refused_or_used(
    tmp_path_factory: pytest.TempPathFactory, run: Run, place: tuple[Any, ...], other: Any
) -> None:
    """As another version of this program may have written it."""
    path, changed = tmp_path_factory.mktemp("fuzz") / "checkpoint-1.pt", io.BytesIO()
    torch.save(replaced(state_of(run.whole), place, other), changed)
    loaded, *_ = readings(path, changed.getvalue(), run.learner)
    if loaded is not None:
        run.learner.step()


def test_one_flipped_bit_is_seen(run: Run, tmp_path: Path) -> None:
    """PyTorch reads past it: the training went on from other weights."""
    path, content = tmp_path / "checkpoint-1.pt", bytearray(run.whole)
    content[len(content) // 2] ^= 1
    torch.load(io.BytesIO(content), weights_only=True)
    path.write_bytes(content)
    with pytest.raises(
        UsageError, match=r"damaged checkpoint .* put a copy of it there, or train with --force"
    ):
        trainer().load(path)
    assert path.read_bytes() == content


def test_a_checkpoint_that_cannot_be_read_is_not_called_damaged(tmp_path: Path) -> None:
    (tmp_path / "checkpoint-1.pt").mkdir()
    with pytest.raises(
        UsageError, match=r"checkpoint-1\.pt: Is a directory; make it a file that can be read"
    ):
        trainer().load(tmp_path / "checkpoint-1.pt")


@pytest.mark.parametrize(
    "changed",
    [{"history": None}, {"checks": [1]}, {"history": [(1, 2)]}, {"config": {}}, {"iteration": "1"}],
    ids=str,
)
def test_a_glance_at_a_checkpoint_of_another_form_is_refused(
    changed: dict[str, object], run: Run, tmp_path: Path
) -> None:
    path = tmp_path / "checkpoint.pt"
    path.write_bytes(run.whole)
    assert glance(path)["iteration"] == 1
    state = state_of(run.whole) | changed
    torch.save({key: value for key, value in state.items() if value is not None}, path)
    with pytest.raises(UsageError, match="damaged checkpoint"):
        glance(path)


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


def test_a_training_with_drawings_by_chance_resumes_to_the_same_bytes(tmp_path: Path) -> None:
    """The library is renewed at iterations 15 and 30: before and after the checkpoint."""
    recipe = replace(SMOKE, varied=0.3, unlabelled=0.1)
    job = job_of([paths.DEFAULT_SHAPES], tmp_path, recipe=recipe)
    whole, half = make_trainer(job), make_trainer(job)
    for _ in range(20):
        half.step()
    half.save(job.checkpoint)
    resumed = make_trainer(replace(job, resume=True))
    for _ in range(35):
        whole.step()
    for _ in range(15):
        resumed.step()
    assert [shape.rows for shape in whole.pools.drawings.shapes] == [
        shape.rows for shape in resumed.pools.drawings.shapes
    ]
    first = make_trainer(job).pools.drawings.shapes
    assert [shape.rows for shape in first] != [shape.rows for shape in whole.pools.drawings.shapes]
    for name, value in whole.ema.items():
        assert torch.equal(value, resumed.ema[name]), name
