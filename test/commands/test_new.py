"""`tilenca new`: what it lays out, what it refuses, and that its firmware is the checkout's."""

import configparser
import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from support.blocks import blocks
from support.reader import parse
from tilenca.base import paths
from tilenca.cli import main
from tilenca.commands import new
from tilenca.model.file import load_model
from tilenca.model.render import is_current, render
from tilenca.shapes.file import load_task

PIO = Path(sys.executable).with_name("pio")


def files_of(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


@pytest.fixture
def made(tmp_path: Path) -> Path:
    folder = tmp_path / "of my own" / "tiles"
    assert main(["new", str(folder)]) == 0
    return folder


def test_the_document_names_the_project_and_all_its_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new", str(tmp_path / "mine"), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["project"] == str(tmp_path / "mine")
    assert set(document["files"]) == files_of(tmp_path / "mine")
    assert {"README.md", ".gitignore", "platformio.ini", "shapes/mine.toml"} <= set(document["files"])


def test_an_empty_folder_is_filled_and_any_other_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["new", "."]) == 0
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    assert main(["new", "."]) == 2
    assert main(["new", "README.md"]) == 2
    assert main(["new", "README.md/below"]) == 2
    assert capsys.readouterr().err.splitlines() == [
        "tilenca: .: not empty; give a new or an empty folder",
        "tilenca: README.md: not a folder; give a new one",
        "tilenca: README.md/below: Not a directory; give a folder that can be made",
    ]
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def test_what_fails_half_way_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(new, "write_files", full)
    (tmp_path / "empty").mkdir()
    assert main(["new", str(tmp_path / "empty")]) == 1
    assert main(["new", str(tmp_path / "mine")]) == 1
    assert list(tmp_path.rglob("*")) == [tmp_path / "empty"]


def test_its_shapes_are_a_task_and_its_firmware_has_the_digits(made: Path) -> None:
    assert load_task(made / "shapes" / "mine.toml").labels == ("L", "t")
    for path, text in render(load_model(paths.DEFAULT_MODEL)).items():
        assert is_current(made / "firmware" / path, text)


def test_its_readme_names_commands_that_exist(made: Path) -> None:
    commands = [command for block in blocks(made / "README.md") for command in block.commands]
    assert len(commands) > 5
    for command in commands:
        parse(shlex.split(command), "README.md")


def settings(ini: Path) -> dict[str, dict[str, str]]:
    config = configparser.ConfigParser(interpolation=None)
    config.read(ini, encoding="utf-8")
    return {name: dict(config[name]) for name in config.sections()}


def test_its_environments_are_the_checkouts(made: Path) -> None:
    mine, ours = settings(made / "platformio.ini"), settings(paths.ROOT / "platformio.ini")
    assert mine["tilenca"] == ours["firmware"]
    for name in ("env:megaatmega2560", "env:board_test"):
        flags = mine[name].pop("build_src_flags", "").replace("tilenca.", "firmware.")
        # What belongs to the checkout's own tests and to its monitor filter.
        for option in ("test_ignore", "monitor_filters"):
            ours[name].pop(option, None)
        assert ours[name].pop("build_src_flags", "") == flags
        assert mine[name] == ours[name]


def test_the_commands_work_on_the_project_they_are_started_in(made: Path, tmp_path: Path) -> None:
    model = str(paths.MODELS / "hex")
    command = [sys.executable, "-m", "tilenca.cli", "export", "--model", model, "--json"]
    done = subprocess.run(command, cwd=made / "shapes", capture_output=True, timeout=60, check=True)
    assert json.loads(done.stdout)["written"] == [
        str(made / "firmware" / path) for path in render(load_model(paths.DEFAULT_MODEL))
    ]


@pytest.mark.skipif(not PIO.exists(), reason="PlatformIO is not installed; run `make setup`")
def test_its_image_is_the_checkouts(made: Path) -> None:
    home = {name: value for name, value in os.environ.items() if name != "PLATFORMIO_CORE_DIR"}
    done = subprocess.run(
        [PIO, "run", "-s", "-d", made, "-e", paths.FIRMWARE_ENV],
        env=home,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    built, ours = paths.built_elf(made), paths.FIRMWARE_ELF
    assert built.with_suffix(".hex").read_bytes() == ours.with_suffix(".hex").read_bytes()
