"""What decides the trained weights, as a checkpoint holds it."""

import json
from dataclasses import replace
from pathlib import Path

from support.training import SMOKE, job_of
from tilenca.base import paths
from tilenca.model.file import load_model
from tilenca.training.config import Config


def config() -> Config:
    return job_of([paths.DEFAULT_SHAPES], Path(), seed=3).config


def test_it_is_as_json_reads_it_back() -> None:
    values = config().as_json()
    assert json.loads(json.dumps(values)) == values
    assert (values["seed"], values["dimensions"]["hidden1"], values["initial"]) == (3, 12, None)


def test_settings_that_do_not_touch_the_weights_are_left_out() -> None:
    other = replace(config(), recipe=replace(SMOKE, validation_runs=SMOKE.validation_runs + 1))
    assert other.as_json() == config().as_json()
    longer = replace(config(), recipe=replace(SMOKE, iterations=SMOKE.iterations + 1))
    assert longer.as_json() != config().as_json()


def test_the_model_that_it_begins_with_is_told_by_its_id() -> None:
    model = load_model(paths.MODELS / "digits")
    assert replace(config(), initial=model).as_json()["initial"] == f"{model.model_id:04X}"
