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
from tilenca.base.parsing import read_json
from tilenca.base.whole_file import write_whole
from tilenca.cluster.client import Cluster
from tilenca.cluster.fingerprint import fingerprint
from tilenca.cluster.tasks import run_tasks
from tilenca.report.experiment import Experiment
from tilenca.report.rows import READERS, Row, Words

Results = dict[str, dict[str, Any]]
LAST_LINES = 5


@dataclass(frozen=True)
class Call:
    """An experiment with its arguments, as a worker gets it."""

    key: str
    arguments: tuple[str, ...]


def command_of(call: Call, folder: Path) -> Words:
    """What is run for a call: its arguments, and those that say where the result goes."""
    alone = ("--jobs", "1", "--out", str(folder / "out")) if call.arguments[0] == "sweep" else ()
    return (*call.arguments, *alone, "--json")


def run_command(_shared: None, call: Call) -> dict[str, Any]:
    """Runs a command of tilenca in a process of its own, and returns its JSON.

    Raises:
        TilencaError: the command failed; the message has its last lines.
    """
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [sys.executable, "-m", "tilenca.cli", *command_of(call, Path(folder))],
            capture_output=True,
            text=True,
            check=False,
            stdin=subprocess.DEVNULL,
        )
    # 1: a check failed, such as a drawing that is not named; the result says which.
    if done.returncode not in (0, 1) or not done.stdout:
        last = " / ".join(done.stderr.strip().splitlines()[-LAST_LINES:])
        raise TilencaError(
            f"{call.key}: tilenca {' '.join(call.arguments)} ended with {done.returncode}: {last}"
        )
    result: dict[str, Any] = json.loads(done.stdout)
    return result


class Folder:
    """The results that a report has so far, a file for each.

    Args:
        path: the folder; it is made.
        measured: files that the results depend on: models, shapes, the firmware.

    A result of other arguments, other software or other files is measured again.
    """

    def __init__(self, path: Path, measured: Sequence[Path]) -> None:
        self.path = path
        path.mkdir(parents=True, exist_ok=True)
        digests = [hashlib.sha256(file.read_bytes()).hexdigest() for file in sorted(measured)]
        self._identity = repr((fingerprint(), digests))

    def _file(self, call: Call) -> Path:
        identity = json.dumps([call.arguments, self._identity])
        return self.path / f"{call.key}-{hashlib.sha256(identity.encode()).hexdigest()[:12]}.json"

    def read(self, call: Call) -> dict[str, Any] | None:
        """The result of a call; None: there is none, or it is damaged."""
        try:
            result: dict[str, Any] = read_json(self._file(call).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return result

    def results(self, calls: Sequence[Call]) -> Results:
        """Those that are there, by their keys."""
        return {call.key: result for call in calls if (result := self.read(call)) is not None}

    def write(self, call: Call, result: dict[str, Any]) -> None:
        """Keeps the result of a call."""
        write_whole(self._file(call), json.dumps(result).encode(), "make room there, or give another --out")


def calls_of(experiments: Sequence[Experiment], quick: bool) -> list[Call]:
    """The calls of a report, the longest first, so that no core waits for one that began late."""
    first = ("suite", "gap.tiles", "plug", "drawn", "paper.settings", "gap.states", "edges", "paper.tiles")
    rank = {key: number for number, key in enumerate(first)}
    calls = [Call(experiment.key, experiment.arguments(quick)) for experiment in experiments]
    return sorted(
        calls, key=lambda call: min((n for key, n in rank.items() if call.key.startswith(key)), default=99)
    )


def measure(
    missing: Sequence[Call], folder: Folder, cluster: Cluster, tell: Callable[[int], None]
) -> Results:
    """Runs calls; returns their results, by their keys.

    Args:
        missing: what the folder lacks.
        folder: where results are kept.
        cluster: where to run.
        tell: called with the number of results that have come.

    Raises:
        TilencaError: a command failed.
    """
    results: Results = {}

    def keep(call: Call, result: dict[str, Any]) -> None:
        folder.write(call, result)
        results[call.key] = result
        tell(len(results))

    run_tasks(cluster, run_command, None, missing, keep)
    return results


def rows_of(experiments: Sequence[Experiment], quick: bool, results: Results) -> dict[str, list[Row]]:
    """The rows of each experiment, by its key."""
    rows = {}
    for experiment in experiments:
        result, words = results[experiment.key], experiment.arguments(quick)
        rows[experiment.key] = READERS[experiment.reader](experiment.key, experiment.what, result, words)
    return rows
