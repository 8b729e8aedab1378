"""From drawings to tiles in one command."""

import argparse
import json
import os
import re
import shutil
import signal
import threading
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from support.alone import alone
from support.making import asked
from support.schemas import fits
from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.cli import main
from tilenca.commands import emulate, make
from tilenca.commands.emulate_runs import EmulationResult
from tilenca.commands.make import STEPS
from tilenca.commands.train_plan import make_plan
from tilenca.emulator.greeting import greeting
from tilenca.evaluation.metrics_file import METRICS_FILE
from tilenca.model import cost
from tilenca.model.file import load_model
from tilenca.views.progress import Tell
from tilenca.views.steps import Steps

QUICK = ("--recipe", "smoke", "--hidden", "12", "--iterations", "30")


def test_drawings_become_tiles_and_a_second_time_only_what_is_missing_is_done(
    two_shapes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "mine"
    words = ["make", str(two_shapes), "--out", str(out), *QUICK]
    with alone("platformio"):
        first = main(words)
    said = capsys.readouterr()
    for number, name in enumerate(STEPS, start=1):
        assert f"[{number}/5] {name}" in said.err
    assert re.search(r"\[2/5\] train; at most \d+ (s|min) left, less if the targets hold early", said.err)
    assert re.search(r"estimated on .*processors?: train at most .*, build about .*, emulate about", said.err)
    assert re.search(r"\[3/5\] measure done in \d+ s: \d+ of \d+ targets held", said.err)
    assert f"for real tiles: tilenca flash --model {out}" in said.err
    assert "not well enough: " in said.out
    assert first in (0, 1), "thirty iterations may leave tiles wrong"
    hello = greeting(paths.model_elf(out))
    assert hello is not None
    assert hello.model_id == load_model(out).model_id
    with alone("platformio"):
        assert main([*words, "--json"]) == first
    again = capsys.readouterr()
    assert "[2/5] train: trained on this file before; --force trains anew" in again.err
    document = json.loads(again.out)
    assert fits("make", document)
    assert document["metrics"] == json.loads((out / "metrics.json").read_text(encoding="utf-8"))
    assert [run["shape"] for run in document["runs"]] == ["1", "7"]
    assert document["model_id"] == f"{hello.model_id:04X}"
    assert main([*words, "--seed", "9"]) == 2
    assert "holds a model of another file, recipe, seed, size or --weights" in capsys.readouterr().err


def test_an_interrupted_training_goes_on_with_the_same_command(
    two_shapes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []

    def interrupt(steps: Steps, name: str, note: str, share: float | None = None) -> None:
        told.append(name)
        if told.count("train") == 1:
            os.kill(os.getpid(), signal.SIGINT)

    out = tmp_path / "mine"
    words = ["make", str(two_shapes), "--out", str(out), *QUICK]
    with monkeypatch.context() as patch:
        patch.setattr(Steps, "move", interrupt)
        assert main(words) == 130
    assert "to go on, run the same command again" in capsys.readouterr().err
    assert (out / "checkpoint-1.pt").exists()
    assert main([*words, "--seed", "2"]) == 2
    assert "holds an unfinished run of another seed; give another --out" in capsys.readouterr().err
    with alone("platformio"):
        assert main(words) in (0, 1)
    assert not (out / "checkpoint-1.pt").exists()
    assert (out / "model.json").exists()


def test_what_ships_and_what_is_there_is_not_overwritten(
    two_shapes: Path, trained_model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["make", str(two_shapes), "--out", str(paths.MODELS / "hex"), *QUICK]) == 2
    assert "comes with tilenca and stays as it is" in capsys.readouterr().err
    other = tmp_path / "other.toml"
    other.write_text(two_shapes.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    assert main(["make", str(other), "--out", str(trained_model), *QUICK]) == 2
    assert "holds a model of another file, recipe, seed, size or --weights" in capsys.readouterr().err


def test_bad_drawings_are_refused_before_anything_is_trained(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    block = "\n".join(["#" * 40] * 40)
    file = tmp_path / "large.toml"
    file.write_text(f'[[shape]]\nlabel = "0"\ngrid = """\n{block}\n"""\n', encoding="utf-8")
    assert main(["make", str(file), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert said == f"tilenca: {file}: shape '0' has 1600 tiles; the most that ids allow are 255\n"
    assert not (tmp_path / "out").exists()


def test_a_trained_model_names_its_recipe(trained_model: Path) -> None:
    about = json.loads((trained_model / "model.json").read_text(encoding="utf-8"))
    assert about["metadata"]["recipe_name"] == "smoke"


def test_a_model_is_the_best_of_the_seeds_that_its_command_names(trained_model: Path) -> None:
    assert make._seeds(load_model(trained_model).metadata) == (5,)
    assert make._seeds({"command": "tilenca train --seed 3 --seeds 2"}) == (3, 4)
    assert make._seeds({}) == ()
    for odd in ("tilenca train --seed", "tilenca train --seed x --seeds 2", "tilenca 'train"):
        assert make._seeds({"command": odd}) == ()


def _changed(model: Path, out: Path, **metadata: object) -> Path:
    """A copy of a model with other metadata."""
    shutil.copytree(model, out)
    about = json.loads((out / "model.json").read_text(encoding="utf-8"))
    about["metadata"] |= metadata
    (out / "model.json").write_text(json.dumps(about), encoding="utf-8")
    return out


def test_a_model_is_the_one_asked_for_only_with_the_same_initial_weights(
    two_shapes: Path, trained_model: Path, tmp_path: Path
) -> None:
    same = asked(two_shapes, trained_model)
    assert make._is_trained(same, make_plan(same))
    args = asked(two_shapes, trained_model, "--weights", str(trained_model))
    with pytest.raises(UsageError, match=r"another .* --weights"):
        make._is_trained(args, make_plan(args))
    begun = _changed(trained_model, tmp_path / "begun", initial=f"{load_model(trained_model).model_id:04X}")
    args = asked(two_shapes, begun, "--weights", str(trained_model))
    assert make._is_trained(args, make_plan(args))


@pytest.mark.parametrize(
    "odd", [{"sources": []}, {"sources": [1]}, {"recipe": {}}, {"command": "tilenca '"}], ids=str
)
def test_a_model_of_odd_metadata_is_another_one(
    odd: dict[str, object], two_shapes: Path, trained_model: Path, tmp_path: Path
) -> None:
    args = asked(two_shapes, _changed(trained_model, tmp_path / "odd", **odd))
    with pytest.raises(UsageError, match="holds a model of another file"):
        make._is_trained(args, make_plan(args))


@pytest.mark.parametrize(
    ("metrics", "why"),
    [
        (None, "a model without its measurements; --force trains it again"),
        ("{}", "a model without its measurements"),
        ('{"rows": [{"key": "drawings"}], "targets_held": ""}', r"metrics\.json: not the metrics of a model"),
        ("{", r"metrics\.json: cannot be read"),
    ],
    ids=str,
)
def test_damaged_measurements_are_told_before_anything_is_built(
    metrics: str | None, why: str, two_shapes: Path, trained_model: Path, tmp_path: Path
) -> None:
    out = _changed(trained_model, tmp_path / "odd")
    (out / METRICS_FILE).unlink()
    if metrics is not None:
        (out / METRICS_FILE).write_text(metrics)
    args = asked(two_shapes, out)
    with pytest.raises(UsageError, match=why):
        make._is_trained(args, make_plan(args))


def test_there_is_no_estimate_for_a_cluster(
    two_shapes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    args = asked(two_shapes, tmp_path, "--scheduler", "tcp://nowhere:1")
    plan, steps = make_plan(args), Steps(STEPS, "train")
    make._check(args, plan, cost.check(plan.dimensions, len(plan.task.labels)), False, steps)
    assert steps.left() == ""
    here = asked(two_shapes, tmp_path)
    make._check(here, plan, cost.check(plan.dimensions, len(plan.task.labels)), False, steps)
    assert "left" in steps.left()


class _Impatient(str):
    """A drawing's name; who writes it first hears of another drawing meanwhile."""

    meanwhile: Callable[[], None]
    other: threading.Thread | None = None

    def __format__(self, how: str) -> str:
        if self.other is None:
            self.other = threading.Thread(target=self.meanwhile)
            self.other.start()
            self.other.join(0.2)
        return str(self)


def test_drawings_that_run_at_once_are_told_at_once(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def emulated(args: argparse.Namespace, shown: Callable[[], AbstractContextManager[Tell]]) -> list[object]:
        with shown() as tell:
            name = _Impatient("1")
            name.meanwhile = lambda: tell("7", 0.5, "")
            tell(name, 0.5, "")
        assert name.other is not None
        name.other.join()
        return []

    monkeypatch.setattr(emulate, "emulate_model", emulated)
    assert make._emulated(argparse.Namespace(), Steps(STEPS, "train")) == []


def test_notes_of_an_emulation_are_told_beside_a_document_too(
    two_shapes: Path, trained_model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    emulate_model = emulate.emulate_model

    def noting(*arguments: Any) -> list[EmulationResult]:
        return [replace(result, notes=("as it happens",)) for result in emulate_model(*arguments)]

    monkeypatch.setattr(emulate, "emulate_model", noting)
    out = tmp_path / "mine"
    shutil.copytree(trained_model, out)
    words = ["make", str(two_shapes), "--out", str(out), "--recipe", "smoke", "--hidden", "12", "--seed", "5"]
    with alone("platformio"):
        assert main([*words, "--json"]) in (0, 1)
    said = capsys.readouterr()
    assert "tilenca: as it happens\n" in said.err
    assert json.loads(said.out)["model"] == str(out)
