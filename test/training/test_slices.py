"""Training in slices, each from a checkpoint to a checkpoint."""

from dataclasses import replace
from pathlib import Path

import pytest

from support.training import SMOKE, job_of
from tilenca.base.errors import UsageError
from tilenca.training.slices import TORCH, Slice, check_torch, train_slice
from tilenca.training.trainer import trained_at


def test_slices_of_one_iteration_end_where_one_piece_does(two_shapes: Path, tmp_path: Path) -> None:
    short = job_of([two_shapes], tmp_path, recipe=replace(SMOKE, iterations=4, check_every=0))
    whole = train_slice(1e6, Slice(short))
    assert whole.done
    slices = [Slice(short)]
    while not slices[-1].done:
        slices.append(train_slice(0.0, slices[-1]))
        assert len(slices) <= 6
    assert len(slices) > 3
    ends = []
    for name, end in (("whole", whole), ("slices", slices[-1])):
        assert end.checkpoint is not None
        (tmp_path / name).write_bytes(end.checkpoint)
        ends.append(trained_at(tmp_path / name, short.config))
    assert ends[0].iteration == ends[1].iteration == 4
    assert ends[0].history == ends[1].history
    assert list(tmp_path.glob("checkpoint-*")) == []


def test_a_checkpoint_that_is_of_no_use_is_a_line(two_shapes: Path, tmp_path: Path) -> None:
    end = train_slice(1e6, Slice(job_of([two_shapes], tmp_path), b"damaged"))
    assert end.failure is not None
    assert end.failure.startswith("seed 5: ")
    assert "damaged checkpoint" in end.failure


def test_another_pytorch_is_refused() -> None:
    check_torch(TORCH)
    with pytest.raises(UsageError, match=r"instead of 0\.1; install the same everywhere"):
        check_torch("0.1")
