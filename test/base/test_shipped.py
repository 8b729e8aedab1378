"""Shapes and models that come with tilenca are found by a short name, from any folder."""

from pathlib import Path

import pytest

from tilenca.base import paths, shipped
from tilenca.base.errors import UsageError
from tilenca.model.file import load_model
from tilenca.shapes.file import load_task


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty working directory, as that of a user with a wheel."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_every_shape_file_and_every_model_has_a_name() -> None:
    assert {"digits", "digits-3x3", "hex", "letters", "pentominoes"} <= set(shipped.shapes_names())
    assert {"digits", "hex", "letters", "pentominoes"} <= set(shipped.model_names())
    for name in shipped.shapes_names():
        assert load_task(shipped.shapes_file(name)).shapes
    for name in shipped.model_names():
        assert load_model(shipped.model_folder(name)).labels


def test_a_path_in_the_tree_is_found_from_anywhere() -> None:
    assert shipped.shapes_file("shapes/hex.toml") == paths.SHAPES / "hex.toml"
    assert shipped.model_folder("models/hex") == paths.MODELS / "hex"


@pytest.mark.parametrize(
    "text", ["hex.toml", "other/hex.toml", "./shapes/no.toml", "a/shapes/hex.toml", "", "HEX"]
)
def test_any_other_path_stays_as_it_is(text: str) -> None:
    assert shipped.shapes_file(text) == Path(text)


@pytest.mark.parametrize("text", ["hex.json", "other/hex", "a/models/hex", ".", "/hex"])
def test_any_other_folder_stays_as_it_is(text: str) -> None:
    assert shipped.model_folder(text) == Path(text)


def test_what_the_user_has_comes_first(elsewhere: Path) -> None:
    (elsewhere / "hex").mkdir()
    (elsewhere / "shapes").mkdir()
    (elsewhere / "shapes" / "hex.toml").touch()
    assert shipped.model_folder("hex") == Path("hex")
    assert shipped.shapes_file("hex") == paths.SHAPES / "hex.toml", "a folder is no shape file"
    assert shipped.shapes_file("shapes/hex.toml") == Path("shapes/hex.toml")
    assert shipped.model_folder("models/hex") == paths.MODELS / "hex"


def test_a_model_in_the_folder_models_here_has_a_short_name_too(elsewhere: Path) -> None:
    (elsewhere / "models" / "mine").mkdir(parents=True)
    assert shipped.model_folder("mine") == Path("mine"), "no model is in it"
    (elsewhere / "models" / "mine" / "model.json").touch()
    assert shipped.model_folder("mine") == Path("models/mine")


def test_a_wrong_name_is_answered_with_the_right_ones() -> None:
    with pytest.raises(UsageError, match=r"^hexx: No such file .* one of: digits .*\bhex\b.* pentominoes$"):
        load_task(shipped.shapes_file("hexx"))
    with pytest.raises(
        UsageError, match=r"^hexx/model\.json: No such file .* one of: damage digits .*\bhex\b.* pentominoes$"
    ):
        load_model(shipped.model_folder("hexx"))


def test_a_model_of_the_project_has_a_short_name_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(paths, "PROJECT", tmp_path)
    own = tmp_path / "models" / "mine"
    assert shipped.model_folder("mine") == Path("mine")
    own.mkdir(parents=True)
    (own / "model.json").touch()
    assert shipped.model_folder("mine") == own
    assert shipped.model_folder("hex") == paths.MODELS / "hex"
