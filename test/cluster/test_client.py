"""Connecting to a cluster: what is refused, and in which words."""

import json
import shutil
import sys
import threading
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

import pytest

from support.jobs import missing, pid
from support.machines import in_this_process, machines
from tilenca.base import paths
from tilenca.base.errors import TilencaError, UsageError
from tilenca.cluster.client import Cluster, open_cluster
from tilenca.cluster.fingerprint import fingerprint

# An editable installation finds its checkout before any path.
WITHOUT_CHECKOUT = (
    "import sys\n"
    "sys.meta_path[:] = [each for each in sys.meta_path if 'editable' not in type(each).__module__]\n"
)


@pytest.fixture(scope="module")
def here() -> Iterator[str]:
    """The address of a scheduler in this process, with one worker."""
    with in_this_process(workers=1) as address:
        yield address


def test_it_knows_the_workers_of_a_scheduler(here: str) -> None:
    with open_cluster(here, 7) as cluster:
        assert (cluster.workers(), cluster.threads()) == (1, 1)
        assert cluster.connected


def test_a_scheduler_may_be_given_as_the_file_it_writes(here: str, tmp_path: Path) -> None:
    (tmp_path / "cluster.json").write_text(json.dumps({"address": here}))
    with open_cluster(str(tmp_path / "cluster.json"), 1) as cluster:
        assert cluster.workers() == 1
    for text in ("", "{}", "[]"):
        (tmp_path / "cluster.json").write_text(text)
        with pytest.raises(UsageError, match=r"^--scheduler [^\n]*cluster.json: [^\n]*$"):
            Cluster(str(tmp_path / "cluster.json"), 1)


def test_the_file_of_a_scheduler_that_is_starting_is_waited_for(
    here: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "cluster.json"
    whole = tmp_path / "whole.json"
    whole.write_text(json.dumps({"address": here}))
    soon = threading.Timer(0.7, whole.replace, [file])
    soon.start()
    with open_cluster(str(file), 1) as cluster:
        assert cluster.workers() == 1
    soon.join()
    monkeypatch.setattr("tilenca.cluster.client.CONNECT_S", 0.1)
    with pytest.raises(UsageError, match="neither an address with a port nor the file of a Dask scheduler"):
        Cluster(str(tmp_path / "never.json"), 1)


def test_without_bokeh_it_says_that_there_is_no_dashboard(here: str, monkeypatch: pytest.MonkeyPatch) -> None:
    known = metadata.version

    def version(package: str) -> str:
        if package == "bokeh":
            raise metadata.PackageNotFoundError(package)
        return known(package)

    monkeypatch.setattr(metadata, "version", version)
    with open_cluster(here, 1) as cluster:
        assert cluster.dashboard().startswith(
            "; no dashboard: bokeh is not installed where the scheduler runs"
        )


def test_no_scheduler_there_is_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tilenca.cluster.client.CONNECT_S", 0.2)
    with pytest.raises(
        UsageError, match=r"--scheduler tcp://127.0.0.1:9: no Dask scheduler answers there; start"
    ):
        Cluster("tcp://127.0.0.1:9", 1)


@pytest.mark.parametrize("address", ["", "nonsense://x", "host:port:more"])
def test_what_is_no_address_is_a_line(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tilenca.cluster.client.CONNECT_S", 0.2)
    with pytest.raises(UsageError, match=r"^--scheduler [^\n]*$"):
        Cluster(address, 1)


def test_a_worker_that_lacks_a_library_is_named(here: str) -> None:
    with pytest.raises(TilencaError, match=r"worker tcp://127.0.0.1:\d+: no simulator; run: make setup"):
        Cluster(here, 1, missing)


def test_no_worker_in_time_is_a_line(tmp_path: Path) -> None:
    with (
        machines(tmp_path / "logs", 0) as some,
        pytest.raises(TilencaError, match="no worker in 0 s; start one"),
    ):
        Cluster(some.address, 1, patience_s=0.1)


def test_a_worker_with_other_code_is_refused_and_named(tmp_path: Path) -> None:
    shutil.copytree(
        paths.PACKAGE, tmp_path / "other" / "tilenca", ignore=shutil.ignore_patterns("__pycache__")
    )
    with (tmp_path / "other" / "tilenca" / "__init__.py").open("a") as file:
        file.write("# another commit\n")
    (tmp_path / "other" / "sitecustomize.py").write_text(WITHOUT_CHECKOUT)
    with machines(tmp_path / "logs", 0) as some:
        some.add_worker(tmp_path / "other")
        with pytest.raises(UsageError) as caught:
            Cluster(some.address, 1)
    said = str(caught.value)
    assert f" instead of {fingerprint().code}; install the same wheel" in said
    assert said.startswith("worker tcp://127.0.0.1:")


def test_the_own_workers_of_a_machine_are_processes_that_end_with_it() -> None:
    with open_cluster(None, 1) as cluster:
        pids = cluster.client.run(pid)
        assert cluster.workers() == 1
    assert all(not Path(f"/proc/{pid}/cmdline").exists() for pid in pids.values())


def test_without_dask_the_remedy_is_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.delitem(sys.modules, "tilenca.cluster.client")
    with pytest.raises(
        UsageError, match="needs Dask distributed, which is not installed; run: make setup-train"
    ):
        __import__("tilenca.cluster.client")
