"""The virtual environment `.venv` and the Python packages in it."""

import re
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from setup.command import ROOT, SetupError, Stamp, digest, run, say

VENV = ROOT / ".venv"
PYTHON = VENV / "bin" / "python"
CONSTRAINTS = ROOT / "constraints.txt"
PYPROJECT = ROOT / "pyproject.toml"

# The extras of pyproject.toml that each level of the set-up needs.
EXTRAS = {
    "demo": ["firmware", "page"],
    "train": ["train", "sweep"],
    "test": ["test", "browser", "wheel"],
    "check": ["check"],
    "docs": ["docs"],
    "web": [],
    "fuzz": [],
}
# What they take on the disk, roughly: it says how long the download may be.
SIZE_MB = {"demo": 110, "train": 1180, "test": 180, "check": 310, "docs": 80, "web": 0, "fuzz": 0}
# The current version is here; an installed package has the version of its installation.
VERSION_FILE = ROOT / "host" / "tilenca" / "__init__.py"


def pinned_version(package: str) -> str:
    """The version of a package in constraints.txt.

    Raises:
        SetupError: the file does not pin it.
    """
    found = re.search(
        rf"^{re.escape(package)}==(\S+)$", CONSTRAINTS.read_text(encoding="utf-8"), re.MULTILINE
    )
    if not found:
        raise SetupError(f"constraints.txt does not pin {package}: add a line {package}==VERSION")
    return found.group(1)


def installed_version(package: str, venv: Path = VENV) -> str | None:
    """The version of a package in the virtual environment, by the name of its folder; None: not there."""
    for info in venv.glob(f"lib/python3*/site-packages/{package}-*.dist-info"):
        return info.name.removesuffix(".dist-info").removeprefix(f"{package}-")
    return None


def make_environment(levels: Sequence[str]) -> None:
    """Creates `.venv` if needed and installs what the levels need, the project itself included.

    Raises:
        SetupError: an installation failed.
    """
    _make_venv()
    _install_levels(levels, tomllib.loads(PYPROJECT.read_text(encoding="utf-8")))
    _install_project()


def _make_venv() -> None:
    if belongs_here(VENV):
        return
    refuse_link(VENV)
    say(f"making the virtual environment .venv (Python {sys.version.split()[0]})")
    interpreter = getattr(sys, "_base_executable", sys.executable)
    run([interpreter, "-m", "venv", "--clear", VENV], "cannot make .venv. Is the disk full or not writable?")


def refuse_link(venv: Path) -> None:
    """Refuses a link to an environment elsewhere: making one here would empty that.

    Raises:
        SetupError: `venv` is a link.
    """
    if venv.is_symlink():
        raise SetupError(
            f"{venv} is a link to {venv.readlink()}, which would be emptied; "
            "remove the link and run the same again"
        )


def belongs_here(venv: Path) -> bool:
    """Whether the environment works and was made at this place: its programs hold their own full path."""
    try:
        # One line, or three where the path is too long for one.
        head = "".join((venv / "bin" / "pip").read_text(encoding="utf-8").splitlines()[:3])
        works = subprocess.run([venv / "bin" / "python", "-c", ""], stdin=subprocess.DEVNULL, check=False)
    except (OSError, UnicodeDecodeError):
        return False
    return works.returncode == 0 and f"{venv}/bin/python" in head


def requirements(level: str, project: dict[str, Any]) -> list[str]:
    """What a level needs beyond the levels below it.

    Args:
        level: one of EXTRAS.
        project: what pyproject.toml says.
    """
    extras = project["project"]["optional-dependencies"]
    wanted = [requirement for extra in EXTRAS[level] for requirement in extras[extra]]
    if level == "demo":
        # Without build isolation, so that what builds the package is pinned like the rest.
        wanted += [*project["project"]["dependencies"], *project["build-system"]["requires"]]
    return wanted


def _install_levels(levels: Sequence[str], project: dict[str, Any]) -> None:
    """Installs what the levels lack, all at once: pip resolves their common dependencies once."""
    wanted = {level: requirements(level, project) for level in levels}
    stamps = {level: _stamp(level, wanted[level]) for level in levels}
    lacking = [level for level in levels if wanted[level] and not stamps[level].is_current()]
    if "demo" not in lacking and installed_version("platformio") != pinned_version("platformio"):
        lacking.insert(0, "demo")
    if not lacking:
        return
    packages = [requirement for level in lacking for requirement in wanted[level]]
    size = sum(SIZE_MB[level] for level in lacking)
    say(
        f"installing Python packages, {size} MB on the disk: {', '.join(dict.fromkeys(map(_name, packages)))}"
    )
    for level in lacking:
        stamps[level].clear()
    _pip("install", "--constraint", CONSTRAINTS, *packages)
    for level in lacking:
        stamps[level].set()


def _stamp(level: str, wanted: Sequence[str]) -> Stamp:
    return Stamp(VENV / f".tilenca-{level}", digest([*wanted, CONSTRAINTS.read_bytes()]))


def _name(requirement: str) -> str:
    return re.split(r"[<>=\[]", requirement)[0]


def _install_project() -> None:
    stamp = Stamp(VENV / ".tilenca-project", digest([PYPROJECT.read_bytes(), VERSION_FILE.read_bytes()]))
    if stamp.is_current() and (VENV / "bin" / "tilenca").exists():
        return
    say("installing tilenca itself")
    stamp.clear()
    _pip("install", "--no-deps", "--no-build-isolation", "--editable", ROOT)
    stamp.set()


def _pip(*arguments: str | Path) -> None:
    quiet = ["-qq", "--disable-pip-version-check", "--no-input"]  # errors only
    run(
        [PYTHON, "-m", "pip", *quiet, *arguments],
        "pip failed, see above. The network is needed this once; run the same again to go on",
    )
