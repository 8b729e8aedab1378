"""`tilenca train --scheduler`: the seeds of a training on a cluster."""

import warnings
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from tilenca.base.stdio import warn
from tilenca.training.progress import Tell

if TYPE_CHECKING:
    from tilenca.training.runner import Job


def train_on_cluster(
    jobs: "Sequence[Job]", scheduler: str, tell: Tell, slice_s: float | None = None
) -> list[str]:
    """Trains every job in slices, wherever there is a free worker; checkpoints come back after each slice.

    Args:
        jobs: the seeds; their folder gets the checkpoints.
        scheduler: of Dask.
        tell: called with the progress after each slice.
        slice_s: seconds of a slice; None: as usual.

    Returns:
        One line for each seed that failed; the others ran to their end.

    Raises:
        TilencaError: there is no such cluster, or a worker cannot do the work.
        KeyboardInterrupt: what had come back is in the checkpoints.
    """
    from tilenca.cluster.client import open_cluster
    from tilenca.cluster.tasks import run_tasks
    from tilenca.training.checkpoint import store_checkpoint
    from tilenca.training.slices import SLICE_S, TORCH, Slice, check_torch, train_slice

    failures: list[str] = []

    def take(begin: Slice, result: Slice) -> Slice | None:
        if result.progress is not None:
            tell(result.progress)
        if result.failure is not None:
            failures.append(result.failure)
            return None
        assert result.checkpoint is not None
        store_checkpoint(begin.job.checkpoint, result.checkpoint)
        return None if result.done else result

    begins = [Slice(job, job.checkpoint.read_bytes() if _resumes(job) else None) for job in jobs]
    with open_cluster(scheduler, 1, partial(check_torch, TORCH)) as cluster:
        warn(f"{len(jobs)} seeds; {cluster.workers()} workers{cluster.dashboard()}")
        with warnings.catch_warnings():
            # A checkpoint of some 30 MB every five minutes: Dask's advice about large graphs is for more.
            warnings.filterwarnings("ignore", message="Sending large graph")
            run_tasks(cluster, train_slice, SLICE_S if slice_s is None else slice_s, begins, take)
    return failures


def _resumes(job: "Job") -> bool:
    return job.resume and job.checkpoint.exists()
