"""Descriptions that tilenca 0.1 wrote."""

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from support.refusal import refusal
from tilenca.model import format_1
from tilenca.model.file import load_model
from tilenca.training.recipe import Recipe


def test_a_model_of_format_1_is_read_and_saved_as_format_2(model: Path, tmp_path: Path) -> None:
    path = model / "model.json"
    today = load_model(model)
    about = json.loads(path.read_text())
    recipe = {
        "rounds": [14, 34],
        "bounded": False,
        "stretch": 10.0,
        "average": 0.9995,
        "quiet_rounds": [1, 2],
    }
    about |= {"format": 1, "made": {**about.pop("metadata"), "recipe": recipe}}
    path.write_text(json.dumps(about))

    old = load_model(model)
    assert old.metadata == dict(today.metadata) | {
        "recipe": {
            "ticks": [14, 34],
            "quantisation_aware": False,
            "stretch": 10.0,
            "ema_decay": 0.9995,
            "undisturbed_ticks": [1, 2],
        }
    }
    assert old.model_id == today.model_id, "tiles that carry the model know it by this id"

    old.save(tmp_path / "copy")
    written = json.loads((tmp_path / "copy" / "model.json").read_text())
    assert (written["format"], written["model_id"]) == (2, about["model_id"])
    assert load_model(tmp_path / "copy").metadata == old.metadata


def test_format_1_has_an_old_name_for_settings_of_today_only() -> None:
    settings = {field.name for field in fields(Recipe)}
    assert set(format_1.RECIPE.values()) <= settings
    assert not set(format_1.RECIPE) & settings, "an old name may not mean something else today"


@pytest.mark.parametrize("made", [[1], None, {"recipe": "default"}])
def test_wrong_metadata_of_format_1_are_refused(model: Path, made: Any) -> None:
    path = model / "model.json"
    about = json.loads(path.read_text()) | {"format": 1, "made": made}
    path.write_text(json.dumps(about))
    assert "metadata, and metadata.recipe" in refusal(model)
