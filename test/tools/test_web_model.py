"""A model for browsers has the integers of the model that the tiles have."""

import json
from base64 import b64decode
from pathlib import Path

import numpy as np
import pytest

from release import web_model
from tilenca.base import paths
from tilenca.model.file import load_model

DIGITS = paths.ROOT / "models" / "digits"


def test_it_reads_back_as_the_same_integers(tmp_path: Path) -> None:
    assert web_model.main([str(DIGITS), str(tmp_path / "digits.json")]) == 0
    read = json.loads((tmp_path / "digits.json").read_text())
    model = load_model(DIGITS)
    assert read["labels"] == list(model.labels)
    assert [read[name] for name in ("channels", "hidden1", "hidden2")] == [
        model.dimensions.channels, model.dimensions.hidden1, model.dimensions.hidden2,
    ]  # fmt: skip
    for name, shape in model.dimensions.shapes().items():
        kind = np.dtype("i1" if name.startswith("w") else "<i2")
        found = np.frombuffer(b64decode(read["weights"][name]), kind).reshape(shape)
        assert (found == model.integer[name]).all()


def test_bad_calls_are_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert web_model.main([]) == 2
    assert web_model.main([str(tmp_path / "none"), str(tmp_path / "out")]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "usage: python -m release.web_model MODEL FILE"
    assert len(lines) == 2
    assert "none" in lines[1]
