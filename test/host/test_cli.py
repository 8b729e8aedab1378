"""The command line as a whole: help, usage errors, exit statuses."""

import subprocess
import sys
from pathlib import Path

import pytest

from tilenca import paths
from tilenca.cli import COMMANDS, main


@pytest.mark.parametrize("command", sorted(COMMANDS))
def test_every_command_has_help(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main([command, "--help"])
    assert caught.value.code == 0
    assert f"tilenca {command}" in capsys.readouterr().out


@pytest.mark.parametrize("arguments", [[], ["no-such-command"], ["emulate", "--no-such-option"]])
def test_a_usage_error_exits_with_2(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "usage:" in captured.err


def test_a_failure_is_one_line_on_stderr(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["emulate", "--shapes", str(tmp_path / "none.toml")]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert captured.err.startswith("tilenca: ")


@pytest.mark.parametrize("launcher", sorted((paths.ROOT / "host").glob("*.py")), ids=lambda path: path.stem)
def test_every_launcher_is_its_command(launcher: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(launcher), "--help"], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "usage: tilenca" in done.stdout


def test_commands_without_tensors_do_not_import_torch() -> None:
    program = (
        "import importlib, sys\n"
        "for name in ('emulate', 'export', 'evaluate', 'devices', 'flash', 'monitor'):\n"
        "    importlib.import_module('tilenca.' + name)\n"
        "sys.exit('torch' in sys.modules)\n"
    )
    assert subprocess.run([sys.executable, "-c", program], timeout=60, check=False).returncode == 0
