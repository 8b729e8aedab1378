"""The plan of a sweep."""

from pathlib import Path

import pytest

from support.sweeps import one_shape, plan
from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.model.file import load_model
from tilenca.sweep.axes import EMULATOR
from tilenca.sweep.plan import digest_of


def test_a_cell_for_each_combination_and_a_row_for_each_drawing() -> None:
    found = plan("loss=0,0.5", "size=drawn,7x6")
    assert len(found.cells) == 4
    assert [len(cell) for cell in found.cells] == [10] * 4
    assert len({row.key for row in found.rows}) == 40
    assert {row.runs for row in found.rows} == {4}


def test_runs_are_of_each_drawing() -> None:
    for row in plan("drawings=damaged", runs=3).rows:
        assert row.runs == 3 * len(row.subject.shapes)


def test_steps_are_as_many_as_the_test_suite_has_for_the_size() -> None:
    found = plan("size=drawn,7x6,12x10,20x16", steps=None, only=("4",))
    assert [row.steps for row in found.rows] == [60, 60, 100, 200]


def test_models_may_be_an_axis() -> None:
    found = plan("model=digits,digits-40", only=("4",))
    assert [row.point["model"] for row in found.rows] == ["digits", "digits-40"]
    assert [row.model_id for row in found.rows] == [
        f"{load_model(paths.MODELS / name).model_id:04X}" for name in ("digits", "digits-40")
    ]
    assert len(set(map(digest_of, found.luggage.models.values()))) == 2


def test_identity_changes_with_all_that_changes_the_numbers(tmp_path: Path) -> None:
    base = plan("loss=0").identity
    assert base == plan("loss=0").identity
    for name, other in {
        "--seed": plan("loss=0", seed=2),
        "--runs": plan("loss=0", runs=5),
        "--steps": plan("loss=0", steps=21),
        "--axis": plan("loss=0.1"),
        "--shape": plan("loss=0", only=("4",)),
        "--shapes": plan("loss=0", files=(one_shape(tmp_path),)),
        "--model": plan("loss=0", model="digits-40"),
    }.items():
        assert name in {key for key in base if base[key] != other.identity[key]}


def test_the_image_travels_with_emulated_tiles(tmp_path: Path) -> None:
    image = tmp_path / "firmware.elf"
    image.write_bytes(b"an image")
    found = plan("loss=0", engine=EMULATOR, image=image)
    assert (found.luggage.image, found.luggage.source) == (b"an image", image)


def test_a_model_that_is_nowhere_is_refused() -> None:
    with pytest.raises(UsageError, match=r"nowhere/model.json"):
        plan("model=nowhere")
