"""What a command says where a project, a build or an extra is not there."""

from pathlib import Path

import pytest

from support.projects import make_build, make_project
from tilenca.base import paths
from tilenca.base.errors import BuildError, UsageError, image_error
from tilenca.base.project import build_remedy, firmware_image, install_remedy, project


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
