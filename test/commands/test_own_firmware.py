"""A model's firmware beside its files."""

import shutil
from pathlib import Path

import pytest

from support.alone import alone
from tilenca.base import paths
from tilenca.base.errors import BuildError
from tilenca.commands import own_firmware
from tilenca.commands.own_firmware import build_beside, image_of, image_to_write
from tilenca.emulator.greeting import greeting
from tilenca.model.file import load_model
from tilenca.training.sessions import noted


def project_files() -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in paths.FIRMWARE.rglob("*") if path.is_file()}


def test_the_image_carries_the_model_and_the_projects_own_firmware_stays(tmp_path: Path) -> None:
    before, model = project_files(), load_model(paths.MODELS / "hex")
    with alone("platformio"):
        image = build_beside(model, tmp_path)
    assert image == image_of(tmp_path) == paths.model_elf(tmp_path)
    hello = greeting(image)
    assert hello is not None
    assert hello.model_id == model.model_id
    assert project_files() == before


def test_sources_that_are_current_stay_and_others_are_brought_up_to_date(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built: list[Path] = []
    monkeypatch.setattr(own_firmware, "build", lambda out, *_: built.append(out))
    model = load_model(paths.MODELS / "hex")
    build_beside(model, tmp_path)
    out = paths.model_firmware(tmp_path)
    sources = {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()}
    main, stray = out / "src" / "main.cpp", out / "src" / "stray.cpp"
    main.write_text("changed")
    stray.write_text("")
    build_beside(model, tmp_path)
    assert main.read_bytes() == (paths.FIRMWARE / "src" / "main.cpp").read_bytes()
    assert not stray.exists()
    assert built == [out, out]
    now = {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()}
    assert now.keys() == sources.keys()
    assert [path for path in now if now[path] != sources[path]] == [main]


def test_a_model_without_a_build_says_how_to_get_one(tmp_path: Path) -> None:
    with pytest.raises(BuildError, match=r"no model is there.*; make one: tilenca make FILE"):
        image_of(tmp_path)
    (tmp_path / "model.json").touch()
    with pytest.raises(BuildError, match=r"no model is there \(did you mean 'hex'\?\)"):
        image_of(Path("hexx"))
    with pytest.raises(
        BuildError, match=r"no firmware was built of it; run: tilenca export --model .* --build"
    ):
        image_of(tmp_path)


def test_a_model_that_is_not_there_yet_is_in_training_or_was_interrupted(tmp_path: Path) -> None:
    with (
        pytest.raises(BuildError, match="its model is still being trained or measured"),
        noted(tmp_path, "tilenca train --out mine", "quick", False),
    ):
        image_of(tmp_path)
    (tmp_path / "checkpoint-1.pt").touch()
    with pytest.raises(BuildError, match="no model yet; go on with: tilenca train --out mine --resume"):
        image_of(tmp_path)


def test_the_projects_own_firmware_is_that_of_the_digits_only_while_it_has_them(
    firmware: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(own_firmware, "firmware_image", lambda: firmware)
    digits = load_model(paths.DEFAULT_MODEL)
    assert image_of(paths.DEFAULT_MODEL) == firmware
    shutil.copytree(paths.MODELS / "hex", tmp_path / "hex")
    monkeypatch.setattr(paths, "DEFAULT_MODEL", tmp_path / "hex")
    with pytest.raises(BuildError, match=rf"has model {digits.model_id:04X}, not [0-9A-F]{{4}} of .*--build"):
        image_of(tmp_path / "hex")


def test_what_is_written_to_tiles_is_built_first_unless_told_or_impossible(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built: list[Path] = []
    monkeypatch.setattr(own_firmware, "build", lambda out, *_: built.append(out))
    model = tmp_path / "hex"
    shutil.copytree(paths.MODELS / "hex", model)
    assert image_to_write(model) == paths.model_elf(model)
    assert built == [paths.model_firmware(model)]
    paths.model_elf(model).parent.mkdir(parents=True)
    paths.model_elf(model).touch()
    assert image_to_write(model, building=False) == paths.model_elf(model)
    monkeypatch.setattr(paths, "PROJECT", None)
    assert image_to_write(model) == paths.model_elf(model)
    assert len(built) == 1
