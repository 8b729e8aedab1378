"""Experiments run as commands in processes of their own, and a report goes on where it was stopped."""

from pathlib import Path

import pytest

from support.machines import in_this_process
from tilenca.base.errors import TilencaError
from tilenca.cluster.client import open_cluster
from tilenca.report.experiments import EXPERIMENTS
from tilenca.report.measure import Call, Folder, calls_of, measure, rows_of, run_command

QUICK = Call("paper.listing", ("evaluate", "--schedule", "listing", "--runs", "1", "--seed", "5", "--json"))


def test_a_command_runs_and_its_result_stays(tmp_path: Path) -> None:
    folder = Folder(tmp_path / "results", [])
    assert folder.read(QUICK) is None
    result = run_command(None, QUICK)
    assert result["runs"] == 1
    folder.write(QUICK, result)
    assert folder.read(QUICK) == result
    told: list[int] = []
    other_folder = Folder(tmp_path / "measured", [])
    with in_this_process(workers=1) as address, open_cluster(address, 1) as cluster:
        assert measure([QUICK], other_folder, cluster, told.append) == {QUICK.key: result}
    assert other_folder.results([QUICK]) == folder.results([QUICK]) == {QUICK.key: result}
    assert told == [1]
    other = Call(QUICK.key, (*QUICK.arguments, "--steps", "10"))
    assert folder.read(other) is None, "other arguments have no result yet"


def test_results_of_another_model_are_measured_again(tmp_path: Path) -> None:
    model = tmp_path / "weights.npz"
    model.write_bytes(b"one")
    Folder(tmp_path / "results", [model]).write(QUICK, {"runs": 1})
    assert Folder(tmp_path / "results", [model]).read(QUICK) == {"runs": 1}
    model.write_bytes(b"other")
    assert Folder(tmp_path / "results", [model]).read(QUICK) is None


def test_a_damaged_result_is_measured_again(tmp_path: Path) -> None:
    folder = Folder(tmp_path, [])
    folder.write(QUICK, {"runs": 1})
    (file,) = tmp_path.iterdir()
    file.write_text('{"runs": ')
    assert folder.read(QUICK) is None


def test_a_command_that_fails_says_which_and_why() -> None:
    wrong = Call("paper.wrong", ("evaluate", "--model", "nowhere", "--seed", "1", "--json"))
    with pytest.raises(TilencaError, match=r"paper\.wrong: tilenca evaluate .* ended with 2: .*nowhere"):
        run_command(None, wrong)


def test_the_longest_jobs_come_first_and_the_commands_of_rows_have_no_options_of_output() -> None:
    calls = calls_of(EXPERIMENTS, quick=False)
    assert calls[0].key == "suite"
    assert sorted(call.key for call in calls) == sorted(experiment.key for experiment in EXPERIMENTS)
    experiments = [experiment for experiment in EXPERIMENTS if experiment.key == "paper.3x3"]
    times = {"median": 8.0, "p95": 12.0}
    result = {"runs": 2, "per_shape": [{}] * 6, "total_agreement": 1.0, "steps_to_agreement": times}
    (rows,) = rows_of(experiments, False, {"paper.3x3": result}).values()
    assert {row.command for row in rows} == {"tilenca evaluate --shapes digits-3x3 --runs 500 --seed 20000"}
    assert rows[0].runs == 12
