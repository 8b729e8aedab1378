"""Model directories: what is read, and that each kind of damage is one line."""

import io
import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.refusal import read_or_refused, refusal
from support.strategies import damaged
from tilenca.base import paths
from tilenca.model.file import Dimensions, load_model
from tilenca.training.recipes import RECIPES


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


def test_the_default_widths_are_those_of_digits_as_drawn() -> None:
    assert Dimensions() == load_model(paths.MODELS / "digits-drawn").dimensions
    assert RECIPES["full"].hidden == Dimensions().hidden1


FILES = {name: (paths.DEFAULT_MODEL / name).read_bytes() for name in ("model.json", "weights.npz")}


@settings(max_examples=60)
@given(st.sampled_from(sorted(FILES)).flatmap(lambda name: st.tuples(st.just(name), damaged(FILES[name]))))
def test_any_bytes_are_the_model_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, changed: tuple[str, bytes]
) -> None:
    folder, (damaged_file, content) = tmp_path_factory.mktemp("fuzz"), changed
    for name, whole in FILES.items():
        (folder / name).write_bytes(whole)
    found = read_or_refused(folder / damaged_file, content, lambda _: load_model(folder), folder)
    assert found is None or found.model_id == load_model(paths.DEFAULT_MODEL).model_id
