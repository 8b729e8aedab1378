"""The command line as a whole: help, usage errors, exit statuses."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tilenca.base import paths
from tilenca.cli import COMMANDS, main
from tilenca.commands import devices
from tilenca.commands.examples import epilog


@pytest.mark.parametrize("command", sorted(COMMANDS))
def test_every_command_has_help(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main([command, "--help"])
    assert caught.value.code == 0
    out = capsys.readouterr().out
    assert f"tilenca {command}" in out
    assert out.endswith(f"{epilog(command)}\n")


def test_help_is_a_word_too(capsys: pytest.CaptureFixture[str]) -> None:
    for words, beginning in ((["help"], "usage: tilenca [-h]"), (["help", "plot"], "usage: tilenca plot")):
        with pytest.raises(SystemExit) as caught:
            main(words)
        assert caught.value.code == 0
        assert capsys.readouterr().out.startswith(beginning)


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (["emualte"], "no command 'emualte' (did you mean 'emulate'?)"),
        (["hlep"], "no command 'hlep' (did you mean 'help'?)"),
        (["emulate", "--shaep=4"], "unrecognized arguments: --shaep=4 (did you mean '--shape'?)"),
        (["emulate", "--qqq"], "unrecognized arguments: --qqq;"),
    ],
)
def test_a_mistyped_word_is_answered_with_the_nearest_one(
    words: list[str], meant: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as caught:
        main(words)
    assert caught.value.code == 2
    assert meant in capsys.readouterr().err


def test_without_a_command_it_lists_them(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    listed = [line.split()[0] for line in captured.out.splitlines() if line.startswith("    ")]
    assert [name for name in listed if name in COMMANDS] == list(COMMANDS)


@pytest.mark.parametrize(
    "arguments", [["--json"], ["no-such-command"], ["emulate", "--no-such-option"], ["emulate", "a\nb"]]
)
def test_a_usage_error_exits_with_2(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    command = "tilenca emulate" if "emulate" in arguments else "tilenca"
    assert captured.err.startswith(f"{command}: ")
    assert captured.err.endswith(f"; see {command} --help\n")
    assert captured.err.count("\n") == 1


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


@pytest.mark.parametrize("launcher", ["flash_all", "monitor"])
def test_a_python_without_the_packages_is_told_in_one_line(launcher: str) -> None:
    command = [sys.executable, "-S", str(paths.ROOT / "host" / f"{launcher}.py"), "--help"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith(f"tilenca: {sys.executable} has no module '")
    assert done.stderr.endswith((".venv/bin/activate\n", " setup\n"))
    assert done.stderr.count("\n") == 1


def test_an_environment_that_lacks_a_module_is_to_be_set_up_not_activated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    activate = tmp_path / ".venv" / "bin" / "activate"
    activate.parent.mkdir(parents=True)
    activate.touch()
    monkeypatch.setattr(paths, "CHECKOUT", tmp_path)
    monkeypatch.setattr(devices, "run", lambda _: importlib.import_module("no_such_module"))
    for prefix, remedy in (("/usr", f". {activate}"), (f"{tmp_path}/.venv", f"make -C {tmp_path} setup")):
        monkeypatch.setattr(sys, "prefix", prefix)
        assert main(["devices"]) == 1
        assert capsys.readouterr().err.endswith(f"has no module 'no_such_module'; first: {remedy}\n")


def test_no_command_imports_torch_before_it_needs_it() -> None:
    program = (
        "import importlib, pkgutil, sys\n"
        "import tilenca.commands\n"
        "names = [module.name for module in pkgutil.iter_modules(tilenca.commands.__path__)]\n"
        "assert {'emulate', 'evaluate', 'set', 'simulate', 'train'} <= set(names), names\n"
        "for name in names:\n"
        "    importlib.import_module('tilenca.commands.' + name)\n"
        "sys.exit('torch' in sys.modules)\n"
    )
    assert subprocess.run([sys.executable, "-c", program], timeout=60, check=False).returncode == 0


def tilenca(redirection: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    """The command with its streams redirected as a shell does."""
    script = f'"$@" {redirection}'
    command = ["bash", "-o", "pipefail", "-c", script, "bash", sys.executable, "-m", "tilenca.cli"]
    buffered = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    return subprocess.run(
        [*command, *map(str, arguments)],
        env=buffered,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


@pytest.mark.parametrize(
    ("redirection", "said"),
    [
        (">/dev/full", "tilenca: standard output: No space left on device; the result is not complete\n"),
        (">&-", "tilenca: standard output is closed; redirect it to a file or to /dev/null\n"),
    ],
)
def test_a_result_that_cannot_be_written_is_a_failure(redirection: str, said: str) -> None:
    done = tilenca(redirection, "export", "--check")
    assert (done.returncode, done.stderr) == (1, said)


def test_a_reader_that_leaves_after_the_work_is_done_changes_nothing() -> None:
    done = tilenca("| :", "export", "--check")
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("redirection", ["2>&-", "2>/dev/full"])
def test_without_stderr_the_result_and_the_status_are_the_same(redirection: str, tmp_path: Path) -> None:
    port, other = os.openpty()
    missing = tmp_path / "missing"  # is told on stderr
    done = tilenca(redirection, "devices", "--port", os.ttyname(other), "--port", missing)
    os.close(port)
    os.close(other)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(done.stdout.splitlines()) == 2
    assert str(missing) not in done.stdout


def test_a_failure_that_nobody_hears_keeps_its_status(tmp_path: Path) -> None:
    for wrong in (["--shapes", tmp_path / "none.toml"], ["--no-such-option"]):
        assert tilenca("2>/dev/full", "emulate", *wrong).returncode == 2


@pytest.mark.parametrize(
    ("failure", "said"),
    [
        (OSError(28, "No space left on device", "/some/file"), "/some/file: No space left on device"),
        (OSError(5, "Input/output error"), "Input/output error"),
        (MemoryError(), "out of memory; close other programs, or give it less to do"),
    ],
)
def test_what_the_system_refuses_is_one_line(
    failure: Exception, said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(_: object) -> int:
        raise failure

    monkeypatch.setattr(devices, "run", fail)
    assert main(["devices"]) == 1
    assert capsys.readouterr().err == f"tilenca: {said}\n"


def test_a_defect_of_ours_is_not_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(devices, "run", lambda _: 1 // 0)
    with pytest.raises(ZeroDivisionError):
        main(["devices"])
