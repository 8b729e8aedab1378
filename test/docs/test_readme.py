"""The README's commands are true: each is known here, and what can run on a test machine runs."""

import os
import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tilenca.base import paths

README = (paths.ROOT / "README.md").read_text(encoding="utf-8")

# How each command of the README is tried: extra arguments that make it short, and the exit status expected.
# Without tiles on USB the fleet commands must say so with 3. `make` targets are asked what they would do.
TRIED: dict[str, tuple[list[str], int]] = {
    "make demo": (["--dry-run"], 0),
    "make test": (["--dry-run"], 0),
    "make setup-train": (["--dry-run"], 0),
    "tilenca emulate --shape 4 --watch": (["--updates", "30"], 0),
    "tilenca train --shapes my-shapes.toml --out models/mine": (["--recipe", "smoke"], 0),
    "tilenca evaluate --model models/mine --shapes my-shapes.toml": (["--runs", "2", "--steps", "5"], 0),
    "tilenca export --model models/mine": (["--out", "firmware-mine"], 0),
    "tilenca devices": (["--port", "none-*"], 3),
    "python host/flash_all.py": (["--no-build", "--port", "none"], 3),
    "python host/monitor.py": (["--port", "none"], 3),  # for a pattern it would wait a little
}
# These two belong together: see the test of them.
SERVE = "tilenca emulate --shape 4 --serve tiles --seconds 20 &"
MONITOR = "tilenca monitor --port 'tiles/*' --seconds 10"
# Tried elsewhere (`pio run` by the set-up).
ELSEWHERE = {
    ". .venv/bin/activate",
    "pio run",
    "tilenca emulate --shapes my-shapes.toml",
    SERVE,
    MONITOR,
}


ENVIRONMENT = os.environ | {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}


def commands() -> list[str]:
    blocks = re.findall(r"^```sh\n(.*?)^```", README, flags=re.MULTILINE | re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line]


def test_every_command_of_the_readme_is_known() -> None:
    assert set(commands()) == set(TRIED) | ELSEWHERE


@pytest.fixture(scope="module")
def reader(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory as the reader's: with the README's own shape file in it."""
    directory = tmp_path_factory.mktemp("reader")
    (drawing,) = re.findall(r"^```toml\n(.*?)^```", README, flags=re.MULTILINE | re.DOTALL)
    (directory / "my-shapes.toml").write_text(drawing, encoding="utf-8")
    (directory / "host").symlink_to(paths.ROOT / "host")
    (directory / "firmware-mine").mkdir()
    (directory / "Makefile").symlink_to(paths.ROOT / "Makefile")
    return directory


def test_the_commands_run_as_written_in_their_order(reader: Path) -> None:
    for command in commands():
        if command not in TRIED:
            continue
        more, status = TRIED[command]
        done = subprocess.run(
            [*shlex.split(command), *more],
            cwd=reader,
            env=ENVIRONMENT,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        assert done.returncode == status, f"{command}: {done.stderr}"
        assert "Traceback" not in done.stderr


def test_tiles_can_be_watched_as_soon_as_they_are_asked_for(reader: Path) -> None:
    serving = subprocess.Popen(
        shlex.split(SERVE.removesuffix(" &")), cwd=reader, env=ENVIRONMENT, stderr=subprocess.PIPE, text=True
    )
    done = subprocess.run(
        [*shlex.split(MONITOR), "--seconds", "1"],
        cwd=reader,
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    serving.send_signal(signal.SIGTERM)
    _, chatter = serving.communicate(timeout=60)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("PORT open") == 10, done.stdout
    assert serving.returncode == 130, chatter
    assert not (reader / "tiles").exists()


@pytest.mark.parametrize("left", ["tiles/tile-01", "tiles.toml", "my-shapes.toml", "models/mine/model.json"])
def test_what_following_the_readme_leaves_is_not_for_git(left: str) -> None:
    if not (paths.ROOT / ".git").exists():
        pytest.skip("not a clone")
    assert subprocess.run(["git", "-C", paths.ROOT, "check-ignore", "-q", left], check=False).returncode == 0


def test_links_lead_somewhere() -> None:
    for document in [
        paths.ROOT / "README.md",
        paths.ROOT / "CONTRIBUTING.md",
        *(paths.ROOT / "docs").glob("*.md"),
    ]:
        for target in re.findall(r"\]\((?!https?:)([^)#]+)", document.read_text(encoding="utf-8")):
            assert (document.parent / target).exists(), f"{document.name} links to {target}"
