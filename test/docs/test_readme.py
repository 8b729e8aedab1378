"""What the README promises beyond its code blocks (test_code_blocks.py): tiles on ports, links, the film."""

import os
import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from tilenca.base import paths

README = (paths.ROOT / "README.md").read_text(encoding="utf-8")
SERVE = "tilenca emulate --shape 4 --serve tiles --seconds 20 &"
MONITOR = "tilenca monitor --port 'tiles/*' --seconds 10"
FILM = "docs/images/agree.gif"
MOST_BYTES = 500_000

ENVIRONMENT = os.environ | {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}


def test_tiles_can_be_watched_as_soon_as_they_are_asked_for(tmp_path: Path) -> None:
    assert f"{SERVE}\n{MONITOR}\n" in README
    serving = subprocess.Popen(
        shlex.split(SERVE.removesuffix(" &")),
        cwd=tmp_path,
        env=ENVIRONMENT,
        stderr=subprocess.PIPE,
        text=True,
    )
    done = subprocess.run(
        [*shlex.split(MONITOR), "--seconds", "1"],
        cwd=tmp_path,
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
    assert not (tmp_path / "tiles").exists()


@pytest.mark.parametrize(
    "left",
    [
        "tiles/tile-01",
        "tiles.toml",
        "my-shapes.toml",
        "models/mine/model.json",
        "models/kept/model.json",
        "my-letters.toml",
        "t.gif",
        "frames.jsonl",
        "lab.jsonl",
        "pins.vcd",
    ],
)
def test_what_following_the_documents_leaves_is_not_for_git(left: str) -> None:
    if not (paths.ROOT / ".git").exists():
        pytest.skip("not a clone")
    assert subprocess.run(["git", "-C", paths.ROOT, "check-ignore", "-q", left], check=False).returncode == 0


def test_links_lead_somewhere() -> None:
    for document in [
        paths.ROOT / "README.md",
        paths.ROOT / "CONTRIBUTING.md",
        *(paths.ROOT / "docs").rglob("*.md"),
    ]:
        for target in re.findall(r"\]\((?!https?:)([^)#]+)", document.read_text(encoding="utf-8")):
            assert (document.parent / target).exists(), f"{document.name} links to {target}"


def test_the_film_shows_the_shape_it_was_made_of() -> None:
    """It repeats for ever, and has a frame for each step of the command in docs/images/agree.toml."""
    film = paths.ROOT / FILM
    assert f"]({FILM})" in README
    assert film.stat().st_size < MOST_BYTES
    recipe = (paths.ROOT / "docs/images/agree.toml").read_text(encoding="utf-8")
    steps = re.search(r"--steps (\d+)", recipe)
    assert steps is not None
    with Image.open(film) as picture:
        assert picture.info["loop"] == 0
        assert getattr(picture, "n_frames", 1) == int(steps[1]) + 1
    assert recipe.count("#", recipe.index("grid")) == 20, "the README says twenty tiles"
