"""The commit that is kept with a run."""

import subprocess
from pathlib import Path

import pytest

from tilenca import __version__
from tilenca.base import paths
from tilenca.base.commit import commit


def test_it_is_the_checkouts_and_says_so_when_files_differ(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def git(*words: str) -> str:
        identity = ("-c", "user.name=n", "-c", "user.email=n@n.invalid")
        command = ["git", "-C", str(tmp_path), *identity, *words]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    git("init", "-q")
    (tmp_path / "file").write_text("1")
    git("add", "file")
    git("commit", "-q", "-m", "One")
    monkeypatch.setattr(paths, "CHECKOUT", tmp_path)
    head = git("rev-parse", "HEAD")
    assert commit() == head[:12]
    (tmp_path / "file").write_text("2")
    assert commit() == f"{head[:12]}-dirty"
    monkeypatch.setenv("PATH", "")
    assert commit() == "unknown"


def test_an_installed_one_says_its_version(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(paths, "CHECKOUT", None)
    assert commit() == f"tilenca {__version__}"
