"""Model directories: what is read, and that each kind of damage is one line."""

import io
import json
import shutil
import zipfile
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.model import format_1
from tilenca.model.file import load_model
from tilenca.training.recipes import Recipe


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A copy of the shipped model."""
    return Path(shutil.copytree(paths.DEFAULT_MODEL, tmp_path / "model"))


def refusal(model: Path) -> str:
    with pytest.raises(UsageError) as caught:
        load_model(model)
    message = str(caught.value)
    assert "\n" not in message
    return message


def npy(array: Any) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def test_a_model_survives_saving_and_loading(model: Path, tmp_path: Path) -> None:
    first = load_model(model)
    first.save(tmp_path / "copy")
    second = load_model(tmp_path / "copy")
    assert (second.model_id, second.labels, second.metadata) == (first.model_id, first.labels, first.metadata)
    assert all((second.floats[name] == first.floats[name]).all() for name in first.floats)


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


@pytest.mark.parametrize(
    ("changes", "fact"),
    [
        ({"labels": [["x"]]}, "labels must be"),
        ({"labels": [{}]}, "labels must be"),
        ({"labels": ["1", "1"]}, "they must differ"),
        ({"metadata": [1]}, "metadata, and metadata.recipe"),
        ({"metadata": None}, "metadata, and metadata.recipe"),
        ({"metadata": {"recipe": "default"}}, "metadata, and metadata.recipe"),
        ({"channels": "21"}, "channels, hidden1, hidden2"),
        ({"channels": 52}, "the most are 51"),
        ({"model_id": "0000"}, "do not belong together"),
        ({"format": 99}, "model format 99"),
    ],
)
def test_a_wrong_description_is_refused(model: Path, changes: dict[str, Any], fact: str) -> None:
    path = model / "model.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | changes))
    assert fact in refusal(model)


@pytest.mark.parametrize("text", ["", "[]", "{", "[" * 100_000, "\xff"])
def test_what_is_no_description_is_refused(model: Path, text: str) -> None:
    (model / "model.json").write_bytes(text.encode("latin-1"))
    assert refusal(model).startswith(str(model / "model.json"))


def archive(**members: bytes) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as writer:
        for name, content in members.items():
            writer.writestr(f"{name}.npy", content)
    return file.getvalue()


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"PK\x03\x04 and no more",
        npy(np.zeros(3)),
        archive(),
        archive(w1=b"no array"),
        archive(w1=npy(np.zeros((40, 105), "U3")), int_w1=npy(np.zeros((40, 105), np.int8))),
        archive(w1=npy(np.zeros(3)), int_w1=npy(np.zeros((40, 105), np.int8))),
    ],
)
def test_damaged_weights_are_refused(model: Path, content: bytes) -> None:
    (model / "weights.npz").write_bytes(content)
    assert refusal(model).startswith(str(model / "weights.npz"))


@pytest.mark.parametrize(
    "damage", [lambda data: data[: len(data) // 2], lambda data: data.replace(b"f4", b"f8")]
)
def test_cut_or_changed_weights_are_refused(model: Path, damage: Callable[[bytes], bytes]) -> None:
    path = model / "weights.npz"
    path.write_bytes(damage(path.read_bytes()))
    assert refusal(model).startswith(str(path))
