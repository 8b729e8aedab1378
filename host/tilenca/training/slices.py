"""Training in slices of time, each on any machine: a slice begins at a checkpoint and ends with one."""

import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path

import torch

from tilenca.base.errors import InterruptedRunError, TilencaError, UsageError
from tilenca.training.progress import Progress
from tilenca.training.runner import Job, advance

TORCH = str(torch.__version__)
SLICE_S = 300.0  # each begins with some seconds of preparation


@dataclass(frozen=True)
class Slice:
    """A slice to do, or one that is done.

    Attributes:
        job: of the seed; its folder is not used.
        checkpoint: to begin at, or at the end; None: the beginning.
        progress: the last report; None: none yet.
        done: whether the training has ended.
        failure: a line, where it cannot go on.
    """

    job: Job
    checkpoint: bytes | None = None
    progress: Progress | None = None
    done: bool = False
    failure: str | None = None


def train_slice(seconds: float, begin: Slice) -> Slice:
    """Trains for a while; a training in slices ends in the same bytes as one in one piece.

    Args:
        seconds: at least one iteration is done.
        begin: where to begin.
    """
    end_s = time.monotonic() + seconds
    last = begin.progress

    def tell(progress: Progress) -> None:
        nonlocal last
        last = progress

    with tempfile.TemporaryDirectory(prefix="tilenca-") as folder:
        job = replace(begin.job, out=Path(folder), resume=begin.checkpoint is not None)
        if begin.checkpoint is not None:
            job.checkpoint.write_bytes(begin.checkpoint)
        try:
            advance(job, tell, lambda: time.monotonic() >= end_s)
        except InterruptedRunError:
            return Slice(begin.job, job.checkpoint.read_bytes(), last)
        except (TilencaError, OSError) as error:
            return replace(begin, progress=last, failure=f"seed {job.config.seed}: {error}")
        return Slice(begin.job, job.checkpoint.read_bytes(), last, done=True)


def check_torch(version: str) -> None:
    """Refuses another version of PyTorch than the given one: its models would have other bytes.

    Raises:
        UsageError: it is another.
    """
    if version != TORCH:
        raise UsageError(f"PyTorch {TORCH} instead of {version}; install the same everywhere")
