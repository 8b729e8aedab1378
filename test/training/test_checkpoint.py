"""A checkpoint is whole or not at all, and of this run or refused."""

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest
import torch

from support.training import SMOKE, job_of, trainer
from tilenca.base import paths
from tilenca.base.errors import TilencaError, UsageError
from tilenca.training.checkpoint import glance
from tilenca.training.runner import make_trainer


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
    "changed",
    [{"history": None}, {"checks": [1]}, {"history": [(1, 2)]}, {"config": {}}, {"iteration": "1"}],
    ids=str,
)
def test_a_glance_at_a_checkpoint_of_another_form_is_refused(
    changed: dict[str, object], tmp_path: Path
) -> None:
    path = tmp_path / "checkpoint.pt"
    trainer().save(path)
    assert glance(path)["iteration"] == 0
    state = torch.load(path, weights_only=True) | changed
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
