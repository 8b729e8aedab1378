"""Completion, asked for as a shell does."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tilenca.cli import COMMANDS
from tilenca.commands.completion import command_asked
from tilenca.training.recipes import RECIPES

pytest.importorskip("argcomplete", reason="the package argcomplete is not installed")
LIMIT_S = 120


def completions(line: str, folder: Path) -> list[str]:
    """What the shell is offered at the end of this line."""
    answer = folder / "answer"
    asked = {"_ARGCOMPLETE": "1", "COMP_LINE": line, "COMP_POINT": str(len(line)), "_ARGCOMPLETE_IFS": "\n"}
    asked |= {"_ARGCOMPLETE_STDOUT_FILENAME": str(answer), "_ARGCOMPLETE_SUPPRESS_SPACE": "1"}
    words = [sys.executable, "-m", "tilenca.cli"]
    done = subprocess.run(
        words, env=os.environ | asked, cwd=folder, capture_output=True, timeout=LIMIT_S, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == b""
    return answer.read_text(encoding="utf-8").split("\n")


def test_commands_options_and_names_are_completed(tmp_path: Path) -> None:
    assert set(completions("tilenca ", tmp_path)) >= set(COMMANDS)
    assert completions("tilenca em", tmp_path) == ["emulate"]
    assert completions("tilenca train --resu", tmp_path) == ["--resume"]
    assert completions("tilenca train --recipe q", tmp_path) == ["quick"]
    assert set(completions("tilenca train --recipe ", tmp_path)) >= set(RECIPES)
    assert completions("tilenca evaluate --schedule cl", tmp_path) == ["clock"]


def test_own_files_are_completed_beside_what_comes_with_tilenca(tmp_path: Path) -> None:
    (tmp_path / "digits-mine.toml").touch()
    found = completions("tilenca make digits", tmp_path)
    assert {"digits", "digits-7x6", "digits-mine.toml"} <= set(found)
    assert completions("tilenca emulate --model pento", tmp_path) == ["pentominoes"]


@pytest.mark.parametrize(
    ("line", "command"),
    [
        ("tilenca ", None),
        ("tilenca em", None),
        ("tilenca emulate ", "emulate"),
        ("tilenca emulate --sh", "emulate"),
        ("tilenca make 'my sha", "make"),
        ("", None),
    ],
)
def test_the_command_of_a_line_is_known_once_it_is_whole(
    line: str, command: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COMP_LINE", line)
    assert command_asked() == command
