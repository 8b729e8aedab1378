"""docs/FLEET.md is true: every command in it is known here and runs, on emulated tiles."""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path

import pytest

from support.alone import alone
from support.lab import Lab
from tilenca.base import paths

LIMIT_S = 1200

STORY = (paths.ROOT / "docs" / "FLEET.md").read_text(encoding="utf-8")

# What makes a command short, or names the lab's ports before there is a tiles.toml.
PORTS = ["--port", "tile-*"]
MORE: dict[str, list[str]] = {
    "tilenca devices": PORTS,
    "python host/flash_all.py": PORTS,
    "tilenca devices --learn --assign": PORTS,
    "tilenca flash": [],
    "tilenca flash --failed": [],
    "tilenca flash --only 3,7,9-12 --force": [],
    "tilenca set brightness 80 --tile 3,7,9-12": [],
    "tilenca set period 500": [],
    "tilenca set preset default": [],
    "python host/monitor.py": ["--seconds", "1"],
    "tilenca monitor --record lab.jsonl": ["--seconds", "12"],
    "tilenca monitor --replay lab.jsonl --from 10 --speed 4": [],
}
# Tried in test_fleet.py and test_readme.py.
ELSEWHERE = {
    "pio run -t upload --upload-port /dev/ttyACM3",
    "pio device monitor --port /dev/ttyACM3",
    "tilenca emulate --shape 8 --serve tiles",
}


def commands() -> list[str]:
    blocks = re.findall(r"^```sh\n(.*?)^```", STORY, flags=re.MULTILINE | re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line]


def test_every_command_of_the_story_is_known() -> None:
    assert commands() == [*MORE, *(command for command in commands() if command in ELSEWHERE)]
    assert set(commands()) == set(MORE) | ELSEWHERE


@pytest.fixture(scope="module")
def lab(firmware: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    """Twelve tiles: as many as the story names by their ids."""
    folder = tmp_path_factory.mktemp("story")
    (folder / "host").symlink_to(paths.ROOT / "host")
    with Lab(firmware, folder, ["####"] * 3) as lab:
        yield lab


def test_the_commands_run_as_written_in_their_order(lab: Lab) -> None:
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    environment = {**lab.environment, "PATH": path}
    for command, more in MORE.items():
        words = shlex.split(command)
        if words[0] == "tilenca":
            words[:1] = [sys.executable, "-m", "tilenca.cli"]
        with alone("pio") if "flash" in command else nullcontext():  # it builds the firmware first
            done = subprocess.run(
                [*words, *more],
                cwd=lab.folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                timeout=LIMIT_S,
                check=False,
            )
        assert done.returncode == 0, f"{command}: {done.stderr}"
        assert "Traceback" not in done.stderr
        assert done.stdout or "--failed" in command, f"{command} says nothing"
