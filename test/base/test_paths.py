"""Where files are, in a checkout and in a project of one's own."""

import subprocess
import sys
from pathlib import Path

import pytest

from tilenca.base import paths
from tilenca.base.errors import BuildError, UsageError, image_error
from tilenca.base.project import build_remedy, firmware_image, install_remedy, project

MARKED = "[platformio]\n[tilenca]\nflags = -O2\n"


def make_project(folder: Path) -> Path:
    folder.mkdir(parents=True)
    (folder / "platformio.ini").write_text(MARKED, encoding="utf-8")
    return folder


def make_build(folder: Path) -> Path:
    elf = paths.built_elf(folder)
    elf.parent.mkdir(parents=True)
    elf.touch()
    return elf


def test_a_checkout_is_its_own_project() -> None:
    assert paths.CHECKOUT is not None
    assert (paths.CHECKOUT / "pyproject.toml").is_file()
    assert paths.ROOT == paths.PROJECT == project() == paths.CHECKOUT
    assert paths.firmware_elf() == paths.FIRMWARE_ELF


def test_the_nearest_project_above_is_found(tmp_path: Path) -> None:
    outer = make_project(tmp_path / "outer")
    inner = make_project(outer / "inner")
    deep = inner / "shapes" / "more"
    deep.mkdir(parents=True)
    (deep / "platformio.ini").write_text("[env:other]\n; [tilenca]\n", encoding="utf-8")
    assert paths.find_project(deep) == inner
    assert paths.find_project(inner) == inner
    assert paths.find_project(outer) == outer
    assert paths.find_project(tmp_path) is None


def test_what_cannot_be_read_is_no_project(tmp_path: Path) -> None:
    outer = make_project(tmp_path / "outer")
    for name, content in (("binary", b"\xff\xfe[tilenca]"), ("plain", b"")):
        (outer / name).mkdir()
        (outer / name / "platformio.ini").write_bytes(content)
    (outer / "folder" / "platformio.ini").mkdir(parents=True)
    assert {paths.find_project(outer / name) for name in ("binary", "plain", "folder")} == {outer}


def test_a_command_works_on_the_project_that_it_was_started_in(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "mine")

    def places() -> str:
        program = "from tilenca.base import paths; print(paths.PROJECT, paths.firmware_elf())"
        command = [sys.executable, "-c", program]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60, check=True)
        return done.stdout

    assert places() == f"{folder} {paths.FIRMWARE_ELF}\n"
    built = make_build(folder)
    assert places() == f"{folder} {built}\n"


def test_a_working_directory_that_is_gone_ends_no_command(tmp_path: Path) -> None:
    (tmp_path / "gone").mkdir()
    script = f"cd {tmp_path}/gone && rmdir ../gone && {sys.executable} -m tilenca.cli --version"
    done = subprocess.run(["sh", "-c", script], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_project_without_a_build_runs_the_image_that_came_along_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = make_project(tmp_path / "mine")
    monkeypatch.setattr(paths, "PROJECT", folder)
    assert firmware_image() == paths.FIRMWARE_ELF
    assert capsys.readouterr().err.startswith(f"{folder} has no build yet")
    elf = make_build(folder)
    assert firmware_image() == elf
    assert capsys.readouterr().err == ""
    assert isinstance(image_error(f"{elf}: damaged"), BuildError)
    assert isinstance(image_error(f"{tmp_path}/given.elf: damaged"), UsageError)


def test_without_a_checkout_the_remedies_are_those_of_an_installed_package(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert install_remedy("train") == "make setup-train"
    assert "make demo" in build_remedy()
    monkeypatch.setattr(paths, "CHECKOUT", None)
    monkeypatch.setattr(paths, "PROJECT", None)
    assert install_remedy("train") == "pip install 'tilenca[train]'"
    assert "make" not in build_remedy() + install_remedy()
    with pytest.raises(BuildError, match="tilenca new DIR"):
        project()
