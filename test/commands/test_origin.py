"""A model's shape files, and the model of a firmware."""

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.commands.origin import (
    folder_of,
    knows_no_damage,
    model_with_id,
    own_drawings,
    own_shapes,
    shapes_or_own,
    why_wrong,
    without_a_dash,
)
from tilenca.model.file import Model, load_model
from tilenca.shapes.file import load_task, shape_table

DIGITS = load_model(paths.DEFAULT_MODEL)


def made_of(metadata: Mapping[str, Any]) -> Model:
    return replace(DIGITS, metadata=metadata)


def source(path: Path) -> dict[str, str]:
    return {"file": path.name, "sha256": hashlib.sha256(path.read_bytes()).hexdigest()}


@pytest.mark.parametrize(
    "folder", sorted(paths.MODELS.glob("*/model.json")), ids=lambda path: path.parent.name
)
def test_every_shipped_model_knows_its_files_and_its_id(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = load_model(folder.parent)
    if model.metadata["shapes"][0].startswith("build/"):  # made of a package's drawings, which do not ship
        with pytest.raises(
            UsageError, match=r"was trained on build/hands/mnist.toml.*give the file with --shapes"
        ):
            own_shapes(model, folder.parent)
    else:
        for path in own_shapes(model, folder.parent):
            assert path.is_file()
            assert path.name in [each["file"] for each in model.metadata["sources"]]
    found = model_with_id(model.model_id)
    assert found is not None
    assert found[0].model_id == model.model_id
    assert capsys.readouterr().err == ""


json_values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text()
    | st.just("a" * 300)
    | st.just("digits.toml"),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(["file", "sha256"]) | st.text(max_size=3), inner, max_size=3)
    ),
    max_leaves=9,
)


@given(st.dictionaries(st.sampled_from(["shapes", "sources"]), json_values))
@example({"shapes": ["a" * 300]})
@example({"shapes": ["a\0b"]})
def test_metadata_of_any_form_name_files_or_are_refused_in_one_line(metadata: dict[str, Any]) -> None:
    model, folder, said = made_of(metadata), paths.DEFAULT_MODEL, ""
    try:
        assert all(path.is_file() for path in own_shapes(model, folder))
    except UsageError as error:
        said = str(error)
    assert said == "" or said.startswith(f"{folder}: was trained on ")
    assert "\n" not in said
    assert why_wrong(model, load_task(paths.DEFAULT_SHAPES)).count("\n") == 0


def test_a_model_that_never_met_damage_says_so() -> None:
    assert knows_no_damage(DIGITS) is None
    assert knows_no_damage(made_of({})) is None
    told = knows_no_damage(made_of({"recipe": {"damaged": 0.0}})) or ""
    assert "never met a drawing with a tile missing" in told


def test_files_that_are_given_come_first() -> None:
    given = [Path("mine.toml")]
    assert shapes_or_own(given, DIGITS, paths.DEFAULT_MODEL) == given
    assert shapes_or_own(None, DIGITS, paths.DEFAULT_MODEL) == own_shapes(DIGITS, paths.DEFAULT_MODEL)


def test_a_model_of_ones_own_finds_its_file_from_anywhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    shapes, folder = tmp_path / "project" / "mine.toml", tmp_path / "project" / "models" / "mine"
    folder.mkdir(parents=True)
    shapes.write_text("first")
    model = made_of({"shapes": ["mine.toml"], "sources": [source(shapes)]})
    assert own_shapes(model, folder) == [shapes]
    assert capsys.readouterr().err == ""
    shapes.write_text("second")
    assert own_shapes(model, folder) == [shapes]
    assert f"note: {shapes} has changed since {folder} was trained on it" in capsys.readouterr().err
    shapes.unlink()
    with pytest.raises(UsageError, match=r"was trained on mine\.toml, which is not there; give the file"):
        own_shapes(model, folder)


def test_the_file_with_the_content_of_the_training_is_preferred(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    other, same = tmp_path / "mine.toml", tmp_path / "models" / "mine.toml"
    same.parent.mkdir()
    other.write_text("other")
    same.write_text("same")
    model = made_of({"shapes": ["mine.toml"], "sources": [source(same)]})
    assert own_shapes(model, same.parent) == [same]


@pytest.mark.parametrize("metadata", [{}, {"shapes": 7}, {"shapes": [7]}, {"sources": [7]}, {"sources": 7}])
def test_without_a_word_about_files_they_are_the_digits(metadata: dict[str, object], tmp_path: Path) -> None:
    assert own_shapes(made_of(metadata), tmp_path) == [paths.DEFAULT_SHAPES]


def test_an_unknown_id_has_no_model_and_a_folder_may_be_asked_first(tmp_path: Path) -> None:
    other = replace(DIGITS, labels=DIGITS.labels[::-1])
    assert model_with_id(other.model_id) is None
    other.save(tmp_path)
    found = model_with_id(other.model_id, tmp_path)
    assert found is not None
    assert found[1] == tmp_path


def test_the_model_of_a_file_is_found_by_what_the_file_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "mine.toml"
    file.write_text(shape_table("4", ["#.", "##"]), encoding="utf-8")
    task = load_task(file)
    assert folder_of(task) is None
    sha256 = hashlib.sha256(file.read_bytes()).hexdigest()
    made_of({"sources": [{"file": "other.toml", "sha256": sha256}]}).save(tmp_path / "models" / "mine")
    assert folder_of(task) == Path("models/mine")
    assert folder_of(load_task(paths.DEFAULT_SHAPES.with_name("letters.toml"))) == paths.MODELS / "letters"


def test_a_model_without_a_dash_says_so() -> None:
    assert without_a_dash(DIGITS) is None
    paper = load_model(paths.MODELS / "paper")
    assert "has no class for other drawings" in str(without_a_dash(paper))


def test_a_wrong_answer_is_told_by_whether_the_model_was_made_of_the_drawings(tmp_path: Path) -> None:
    model, own = DIGITS, load_task(paths.DEFAULT_SHAPES)
    ours = f"{model.model_id:04X}"
    assert "was made of this file, and does not hold it" in why_wrong(model, own)
    assert "and does not hold it" in why_wrong(model, own, (7, 6))
    assert "was made of this file, and never trained at 24x20; give the file [sizes]" in why_wrong(
        model, own, (24, 20)
    )
    (tmp_path / "mine.toml").write_text(shape_table("4", ["#.", "##"]), encoding="utf-8")
    told = why_wrong(model, load_task(tmp_path / "mine.toml"))
    assert told.startswith(f"model {ours} was made of digits.toml digits-3x3.toml, and takes these for")
    assert (
        "put these drawings, with their labels, into a copy of shapes/digits.toml and run tilenca make"
        in told
    )
    assert "the recipe that knows damage, --recipe full (" in told
    assert told.endswith("; more reasons: docs/how-to/debug.md")
    signs = made_of({"sources": [{"file": "signs.toml", "sha256": "0"}]})
    told = why_wrong(signs, load_task(tmp_path / "mine.toml"))
    assert "into signs.toml and run tilenca make signs.toml --force; or train" in told
    without = why_wrong(replace(model, metadata={}), own)
    assert without.startswith(f"model {ours} was made of other drawings")


def test_the_drawings_that_a_model_was_made_of_are_known_in_other_files_too(tmp_path: Path) -> None:
    own = load_task(paths.DEFAULT_SHAPES)
    assert own_drawings(DIGITS, tmp_path, own) == {shape.name for shape in own.shapes}
    text = shape_table("4", own.find("4").rows) + shape_table("4", ["#.", "##"])
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    mine = load_task(tmp_path / "mine.toml")
    assert own_drawings(DIGITS, tmp_path, mine) == {"4"}, "4@2 is none of its drawings"
    assert own_drawings(replace(DIGITS, metadata={}), tmp_path, mine) == set()
