"""A Python environment with the built wheel and its dependencies, and nothing else: no compiler, no checkout.

The dependencies are linked one by one from the environment that runs the tests. So no network is needed, and
nothing is there by chance that the wheel does not ask for.
"""

import importlib.metadata
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from packaging.requirements import Requirement

SITE = f"lib/python{sys.version_info.major}.{sys.version_info.minor}/site-packages"
LIMIT_S = 300


def distributions(requirement: Requirement, seen: set[str]) -> Iterator[importlib.metadata.Distribution]:
    """What a requirement brings: its distribution and, transitively, what that requires; each once."""
    key = f"{requirement.name.lower()}[{','.join(sorted(requirement.extras))}]"
    if key in seen:
        return
    seen.add(key)
    found = importlib.metadata.distribution(requirement.name)
    yield found
    for text in found.requires or []:
        needed = Requirement(text)
        if needed.marker is None or any(
            needed.marker.evaluate({"extra": extra}) for extra in ("", *requirement.extras)
        ):
            yield from distributions(needed, seen)


class EmptyEnvironment:
    """A virtual environment in `folder/venv`, and a home without anything in `folder/home`."""

    def __init__(self, folder: Path, wheel: Path, requirements: Sequence[str]) -> None:
        """Makes the environment.

        Args:
            folder: for all its files.
            wheel: is installed without its dependencies.
            requirements: the dependencies, which the environment of the tests must have.
        """
        self.venv, self.home = folder / "venv", folder / "home"
        self.home.mkdir(parents=True)
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", self.venv], check=True)
        pip = [sys.executable, "-m", "pip", "-qq", "--disable-pip-version-check", "--no-input"]
        install = ["--python", f"{self.venv}/bin/python", "install", "--no-deps", "--no-index", str(wheel)]
        subprocess.run([*pip, *install], check=True, stdin=subprocess.DEVNULL)
        seen: set[str] = set()
        for requirement in requirements:
            for distribution in distributions(Requirement(requirement), seen):
                self._link(distribution)

    def _link(self, distribution: importlib.metadata.Distribution) -> None:
        site = Path(str(distribution.locate_file("")))
        for top in {file.parts[0] for file in distribution.files or []} - {"..", "__pycache__"}:
            link = self.venv / SITE / top
            if not link.is_symlink():
                link.symlink_to(site / top)

    def environment(self, *programs: str | Path) -> dict[str, str]:
        """The variables: only the environment's own programs are found, and those given by their paths."""
        folder = self.home / "bin"
        folder.mkdir(exist_ok=True)
        for program in programs:
            link = folder / Path(program).name
            if not link.is_symlink():
                link.symlink_to(program)
        path = f"{self.venv}/bin" + (f":{folder}" if programs else "")
        kept = {name: os.environ[name] for name in ("LANG", "TMPDIR") if name in os.environ}
        return {**kept, "PATH": path, "HOME": str(self.home)}

    def run(
        self, folder: Path, *words: str | Path, environment: dict[str, str] | None = None
    ) -> subprocess.CompletedProcess[str]:
        """Runs a program of the environment in a folder; a traceback is a failure of the test."""
        done = subprocess.run(
            [self.venv / "bin" / words[0], *words[1:]],
            cwd=folder,
            env=environment or self.environment(),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=LIMIT_S,
            check=False,
        )
        assert "Traceback" not in done.stderr, done.stderr
        return done
