"""Where files are, in a checkout and in a project of one's own."""

import subprocess
import sys
from pathlib import Path

from support.projects import make_build, make_project
from tilenca.base import paths
from tilenca.base.project import project


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
