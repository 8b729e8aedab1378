"""Which models the page offers, and which drawings with each."""

import shutil
import threading
from pathlib import Path

import pytest

from tilenca.base import paths
from tilenca.base.errors import BuildError
from tilenca.commands.page_models import page_models
from tilenca.model.file import load_model
from tilenca.protocol.stream_fields import MOST_TILES


def test_the_firmwares_own_comes_first_and_those_that_ship_follow() -> None:
    models = page_models(None, None, ())
    names = [one.name for one in models]
    assert names[0] == "digits"
    assert {"letters", "hex", "pentominoes", "paper"} <= set(names)
    assert "handwriting" not in names, "its drawings do not ship"
    letters = next(one for one in models if one.name == "letters")
    assert letters.offer.labels == load_model(paths.MODELS / "letters").labels
    assert letters.offer.drawings[0].name.startswith("letters/")
    for one in models:
        assert all(len(drawing.shape.cells) <= MOST_TILES for drawing in one.offer.drawings)


def test_the_digits_have_the_drawings_of_all_sizes() -> None:
    files = {drawing.name.split("/")[0] for drawing in page_models(None, None, ())[0].offer.drawings}
    assert files == {"digits", "digits-3x3", "digits-7x6"}


def test_a_named_model_comes_first_also_one_that_is_not_built() -> None:
    models = page_models(None, paths.MODELS / "hex", ())
    assert models[0].name == "hex"
    assert models[0].id_text == "E27F"
    assert [one.name for one in models].count("hex") == 1


def test_an_image_or_shapes_of_ones_own_are_offered_alone(firmware: Path) -> None:
    [image] = page_models(firmware, None, ())
    assert (image.name, image.find_image()) == ("digits", firmware)
    [hex_only] = page_models(None, None, [paths.SHAPES / "hex.toml"])
    assert hex_only.offer.labels == tuple("0123456789AbCdEF")


def test_an_image_that_goes_away_is_not_built(firmware: Path, tmp_path: Path) -> None:
    copy = tmp_path / "some.elf"
    copy.write_bytes(firmware.read_bytes())
    [model] = page_models(copy, None, ())
    copy.unlink()
    with pytest.raises(BuildError, match="no such file any more"):
        model.image(threading.Event())


def test_firmware_beside_a_model_of_other_weights_is_none(
    firmware: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "hex"
    shutil.copytree(paths.MODELS / "hex", folder, ignore=shutil.ignore_patterns("firmware"))
    image = paths.model_elf(folder)
    image.parent.mkdir(parents=True)
    shutil.copyfile(firmware, image)
    model = page_models(None, folder, ())[0]
    assert model.find_image() is None, "it is of the digits"
    monkeypatch.setattr(paths, "PROJECT", None)
    with pytest.raises(BuildError, match="another model"):
        model.image(threading.Event())


def test_an_installed_package_is_not_built_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "hex"
    shutil.copytree(paths.MODELS / "hex", folder, ignore=shutil.ignore_patterns("firmware"))
    monkeypatch.setattr(paths, "CHECKOUT", None)
    monkeypatch.setattr(paths, "MODELS", tmp_path)
    model = page_models(None, folder, ())[0]
    with pytest.raises(BuildError, match="no firmware was built of it"):
        model.image(threading.Event())
    assert not paths.model_firmware(folder).exists()
