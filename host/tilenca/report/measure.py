"""Runs the experiments' commands on a cluster, and keeps each result in a file, so that a report goes on."""

import hashlib
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tilenca.base.errors import TilencaError
from tilenca.base.whole_file import write_whole
from tilenca.cluster.client import Cluster
from tilenca.cluster.fingerprint import fingerprint
from tilenca.cluster.tasks import run_tasks
from tilenca.report.experiments import Experiment
from tilenca.report.rows import READERS, Row

Results = dict[str, dict[str, Any]]
LAST_LINES = 5


@dataclass(frozen=True)
class Job:
    """An experiment with its arguments, as a worker gets it."""

    key: str
    arguments: tuple[str, ...]


def run_command(_shared: None, job: Job) -> dict[str, Any]:
    """Runs a command of tilenca in a process of its own, and returns its JSON.

    Raises:
        TilencaError: the command failed; the message has its last lines.
    """
    with tempfile.TemporaryDirectory() as folder:
        out = ["--out", str(Path(folder) / "out")] if job.arguments[0] == "sweep" else []
        done = subprocess.run(
            [sys.executable, "-m", "tilenca.cli", *job.arguments, *out],
            capture_output=True,
            text=True,
            check=False,
            stdin=subprocess.DEVNULL,
        )
    # 1: a check failed, such as a drawing that is not named; the result says which.
    if done.returncode not in (0, 1) or not done.stdout:
        last = " / ".join(done.stderr.strip().splitlines()[-LAST_LINES:])
        raise TilencaError(
            f"{job.key}: tilenca {' '.join(job.arguments)} ended with {done.returncode}: {last}"
        )
    result: dict[str, Any] = json.loads(done.stdout)
    return result


class Folder:
    """The results that a report has so far, a file for each.

    Args:
        path: the folder; it is made.

    A result of other arguments or of other software is measured again.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        path.mkdir(parents=True, exist_ok=True)
        self._software = repr(fingerprint())

    def _file(self, job: Job) -> Path:
        identity = json.dumps([job.arguments, self._software])
        return self.path / f"{job.key}-{hashlib.sha256(identity.encode()).hexdigest()[:12]}.json"

    def read(self, job: Job) -> dict[str, Any] | None:
        """The result of a job; None: there is none, or it is damaged."""
        try:
            result: dict[str, Any] = json.loads(self._file(job).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return result

    def write(self, job: Job, result: dict[str, Any]) -> None:
        """Keeps the result of a job."""
        write_whole(self._file(job), json.dumps(result).encode(), "make room there, or give another --out")


def jobs_of(experiments: Sequence[Experiment], quick: bool) -> list[Job]:
    """The jobs of a report, the longest first, so that no core waits for one that began late."""
    first = ("suite", "paper.settings", "gap.tiles", "edges", "paper.tiles")
    rank = {key: number for number, key in enumerate(first)}
    jobs = [Job(experiment.key, experiment.arguments(quick)) for experiment in experiments]
    return sorted(
        jobs, key=lambda job: min((n for key, n in rank.items() if job.key.startswith(key)), default=99)
    )


def measure(
    jobs: Sequence[Job], folder: Folder, cluster: Cluster | None, tell: Callable[[int], None]
) -> Results:
    """The results of all jobs, by their keys; runs those that the folder lacks.

    Args:
        jobs: what to run.
        folder: where results are kept.
        cluster: where to run; None: nothing is missing.
        tell: called with the number of results that are there.

    Raises:
        TilencaError: a command failed.
    """
    results = {job.key: result for job in jobs if (result := folder.read(job)) is not None}
    missing = [job for job in jobs if job.key not in results]

    def keep(job: Job, result: dict[str, Any]) -> None:
        folder.write(job, result)
        results[job.key] = result
        tell(len(results))

    tell(len(results))
    if cluster is not None and missing:
        run_tasks(cluster, run_command, None, missing, keep)
    return results


def rows_of(experiments: Sequence[Experiment], quick: bool, results: Results) -> dict[str, list[Row]]:
    """The rows of each experiment, by its key."""
    rows = {}
    for experiment in experiments:
        words = tuple(word for word in experiment.arguments(quick) if word != "--json")
        words = tuple(word for n, word in enumerate(words) if "--jobs" not in words[max(0, n - 1) : n + 1])
        rows[experiment.key] = READERS[experiment.reader](
            experiment.key, experiment.what, results[experiment.key], words
        )
    return rows
