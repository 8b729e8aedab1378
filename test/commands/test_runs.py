"""tilenca runs: what was trained where, and how it went."""

import json
import shutil
from pathlib import Path

import pytest

from support.schemas import fits
from support.training import job_of
from tilenca.base import paths
from tilenca.cli import main
from tilenca.model.file import load_model
from tilenca.training.runner import make_trainer
from tilenca.training.sessions import noted


@pytest.fixture
def folder(two_shapes: Path, trained_model: Path, tmp_path: Path) -> Path:
    """A finished training, an unfinished one, and something that is neither."""
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "done").symlink_to(trained_model, target_is_directory=True)
    (tmp_path / "begun").mkdir()
    job = job_of([two_shapes], tmp_path / "begun", seed=3)
    trainer = make_trainer(job)
    for _ in range(7):
        trainer.step()
    trainer.measured(0.25, {"drawings": 0.5})
    trainer.save(job.checkpoint)
    with noted(tmp_path / "begun", "tilenca train --out begun", "smoke", goes_on=False):
        pass
    (tmp_path / "nothing").mkdir()
    return tmp_path


def test_finished_and_unfinished_trainings_are_told_with_what_they_reached(
    folder: Path, trained_model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["runs", str(folder / "begun"), str(trained_model), "--json"]) == 0
    runs = {run["run"]: run for run in json.loads(capsys.readouterr().out)["runs"]}
    begun, done = runs[str(folder / "begun")], runs[str(trained_model)]
    assert (begun["state"], begun["recipe"], begun["seeds"]) == ("resumable", "smoke", [3])
    assert (begun["iterations"], begun["planned"], begun["shortfall"]) == (7, 40, 0.25)
    assert begun["command"] == "tilenca train --out begun"
    metrics = json.loads((trained_model / "metrics.json").read_text(encoding="utf-8"))
    assert f"{done['held']} of {done['targets']}" == metrics["targets_held"]
    assert len(done["missed"]) == done["targets"] - done["held"]
    assert done["model_id"] == f"{load_model(trained_model).model_id:04X}"
    assert (done["state"], done["recipe"], done["seeds"], done["iterations"]) == ("done", "smoke", [5], 40)
    assert done["seconds"] > 0


def test_the_list_is_a_table_and_says_how_to_go_on(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["runs", str(folder / "begun")]) == 0
    said = capsys.readouterr()
    header, row = said.out.splitlines()
    assert header.split() == ["run", "state", "recipe", "seed", "iterations", "time", "targets", "missed"]
    assert row.split()[1:7] == ["resumable", "smoke", "3", "7", "of", "40"]
    assert f"to go on with {folder / 'begun'}: tilenca train --out begun --resume" in said.err


def test_curves_of_all_of_them_are_drawn_over_each_other(
    folder: Path, trained_model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = folder / "runs.svg"
    assert main(["runs", str(folder / "begun"), str(trained_model), "--plot", str(picture)]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == str(picture)
    assert picture.stat().st_size > 10_000
    before = picture.read_bytes()
    assert main(["runs", str(folder / "begun"), str(trained_model), "--plot", str(picture)]) == 0
    assert picture.read_bytes() == before


def test_all_models_that_ship_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["runs", str(paths.MODELS), "--json"]) == 0
    runs = {Path(run["run"]).name: run for run in json.loads(capsys.readouterr().out)["runs"]}
    assert runs["digits"]["recipe"] == "refine"
    assert runs["digits-drawn"]["recipe"] == "full"
    assert runs["digits"]["held"] < runs["digits"]["targets"]


def test_a_damaged_training_is_told_and_left_out(
    folder: Path, trained_model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "nothing" / "model.json").write_text("{}")
    assert main(["runs", str(folder / "nothing"), str(trained_model), "--json"]) == 0
    said = capsys.readouterr()
    assert len(json.loads(said.out)["runs"]) == 1
    assert said.err.startswith(f"note: {folder / 'nothing'}")


@pytest.mark.parametrize("metrics", ["[]", '{"rows": [{"key": "drawings"}]}', '{"iterations": "many"}', "{"])
def test_damaged_metrics_are_told_and_the_others_listed(
    metrics: str, folder: Path, trained_model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("model.json", "weights.npz"):
        shutil.copy(trained_model / name, folder / "nothing")
    (folder / "nothing" / "metrics.json").write_text(metrics)
    assert main(["runs", str(folder), "--json"]) == 0
    said = capsys.readouterr()
    assert [Path(run["run"]).name for run in json.loads(said.out)["runs"]] == ["begun"]
    assert said.err.startswith(f"note: {folder / 'nothing' / 'metrics.json'}: ")
    assert said.err.count("\n") == 1


def test_a_history_without_a_loss_is_told_and_the_others_drawn(
    folder: Path, trained_model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("model.json", "weights.npz"):
        shutil.copy(trained_model / name, folder / "nothing")
    (folder / "nothing" / "history.csv").write_text("iteration,agreement\n1,0.5\n")
    picture = folder / "runs.svg"
    assert main(["runs", str(folder / "nothing"), str(trained_model), "--plot", str(picture)]) == 0
    assert f"note: {folder / 'nothing' / 'history.csv'}: has no loss" in capsys.readouterr().err
    assert picture.exists()


def test_a_training_is_listed_from_its_beginning_and_one_that_left_nothing_is_told(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["runs", str(folder / "nothing"), str(folder / "begun"), "--json"]
    with noted(folder / "nothing", "tilenca train --out nothing", "smoke", goes_on=False):
        assert main(words) == 0
        document = json.loads(capsys.readouterr().out)
        assert fits("runs", document)
        (run,) = (run for run in document["runs"] if run["run"] == str(folder / "nothing"))
        assert (run["state"], run["recipe"], run["iterations"]) == ("running", "smoke", None)
        assert main(words[:-1]) == 0
        capsys.readouterr()
    assert main(words) == 0
    assert "ended before there was anything to keep" in capsys.readouterr().err


@pytest.mark.parametrize(("place", "message"), [("nothing", "no training there"), ("gone", "no such folder")])
def test_a_folder_without_trainings_is_refused(
    place: str, message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["runs", str(folder / place)]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
