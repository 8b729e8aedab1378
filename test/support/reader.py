"""A reader who follows a document: a folder like a clone, and commands that run in it or are parsed only."""

import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from configparser import ConfigParser
from pathlib import Path

from support import objects
from support.blocks import Block
from tilenca import cli
from tilenca.base import paths

LIMIT_S = 300
ACTIVATE = ". .venv/bin/activate"
PARSED_BY_TILENCA = {"host/flash_all.py": "flash", "host/monitor.py": "monitor"}
# What the reader's own commands may change is a copy; the rest is a link.
COPIED = ("firmware", "platformio.ini", "platformio.local.ini")
LINKED = ("Makefile", "host", "shapes", "tools", "docs")
OURS = {"tilenca", "python"}  # the commands that take a mark's arguments
ENDED = {0, 130}  # by itself, or by the signal that ends the page


class Reader:
    """Runs the blocks of one page; use it as a context manager, which ends what runs in the background."""

    def __init__(self, folder: Path) -> None:
        """Makes the folder look like a clone."""
        self._folder = folder
        self._background: list[tuple[str, subprocess.Popen[str]]] = []
        path = {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
        self._environment = os.environ | path | objects.environment()
        for name in LINKED:
            (folder / name).symlink_to(paths.ROOT / name)
        (folder / "models").mkdir()
        for model in paths.MODELS.iterdir():
            (folder / "models" / model.name).symlink_to(model)
        # Where platformio.local.ini has PlatformIO's packages.
        (folder / "build").mkdir()
        (folder / "build" / "platformio").symlink_to(paths.BUILD / "platformio")
        for name in COPIED:
            source = paths.ROOT / name
            if source.is_dir():
                shutil.copytree(source, folder / name)
            elif source.exists():
                shutil.copy(source, folder / name)

    def follow(self, block: Block) -> None:
        """Does what a block says.

        Raises:
            AssertionError: a command fails, or its arguments are none that it has.
        """
        if block.file_name:
            (self._folder / block.file_name).write_text(block.text, encoding="utf-8")
        elif block.language == "python":
            self._follow_python(block)
        elif block.language == "sh":
            for command in block.commands:
                self._follow_command(block, command)

    def _follow_python(self, block: Block) -> None:
        compile(block.text, block.place, "exec")
        if block.runs:
            self._run(block, [sys.executable, "-c", block.text])

    def _follow_command(self, block: Block, command: str) -> None:
        background = command.endswith(" &")
        words = shlex.split(command.removesuffix(" &"), comments=True)
        if command == ACTIVATE:
            return
        if words[0] == "cd":
            self._folder = self._folder / words[1]
            assert self._folder.is_dir(), f"{block.place}: there is no folder {words[1]}"
            return
        if words[0] == "make":
            self._run(block, [*words, "--dry-run"])
        elif not block.runs:
            parse(words, block.place)
        elif background:
            process = subprocess.Popen(
                words, cwd=self._folder, env=self._environment, stderr=subprocess.PIPE, text=True
            )
            self._background.append((command, process))
        else:
            self._run(block, [*words, *(block.more if words[0] in OURS else ())])

    def _run(self, block: Block, words: list[str]) -> None:
        done = subprocess.run(
            words,
            cwd=self._folder,
            env=self._environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=LIMIT_S,
            check=False,
        )
        said = f"{block.place}: {shlex.join(words)}\n{done.stdout}{done.stderr}"
        assert done.returncode == block.status, f"ended with {done.returncode}, not {block.status}: {said}"
        assert "Traceback" not in done.stderr, said

    def __enter__(self) -> "Reader":
        return self

    def __exit__(self, *_error: object) -> None:
        for _, process in self._background:
            process.send_signal(signal.SIGTERM)
        for command, process in self._background:
            _, chatter = process.communicate(timeout=LIMIT_S)
            assert process.returncode in ENDED, f"{command} ended with {process.returncode}: {chatter}"


def parse(words: list[str], place: str) -> None:
    """Checks a command that cannot run in a test.

    Raises:
        AssertionError: the command or an argument of it does not exist.
    """
    program, *arguments = words
    if program == "python":
        assert (paths.ROOT / arguments[0]).exists(), f"{place}: there is no {arguments[0]}"
        program, arguments = "tilenca", [PARSED_BY_TILENCA[arguments[0]], *arguments[1:]]
    if program == "tilenca":
        try:
            cli.build_parser(arguments[0]).parse_args(arguments)
        except SystemExit as ended:
            raise AssertionError(f"{place}: tilenca does not accept {shlex.join(arguments)}") from ended
    elif program == "pio":
        project = ConfigParser(interpolation=None)
        project.read(paths.ROOT / "platformio.ini")
        for environment in re.findall(r"-e (\S+)", shlex.join(arguments)):
            assert f"env:{environment}" in project, f"{place}: platformio.ini has no {environment}"
    else:
        assert program in {"avr-gdb", "gtkwave"}, f"{place}: nobody knows the command {program}"
