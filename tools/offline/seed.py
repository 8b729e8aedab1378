"""Fills a PlatformIO core directory with stand-ins: python -m offline.seed DIRECTORY, with tools on the path.

PlatformIO takes a package for installed when its folder holds a manifest and a `.piopm` whose name, owner and
version fit the requirement. So every stand-in is a folder of links to the files of a Debian package, with
these two beside them. Their versions end in `+debian...` or `+offline`, which PlatformIO ignores when it
compares and shows when it builds: a log never hides what compiled it.
"""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

from offline.boards import board_manifest, parse_boards

HERE = Path(__file__).resolve().parent
BUILDERS = HERE / "builders"
CORE_DIR = "build/platformio"
MARK = "; Written by tools/offline/seed.py"

DEBIAN_PACKAGES = [
    "arduino-core-avr",
    "avr-libc",
    "avrdude",
    "binutils-avr",
    "cppcheck",
    "doctest-dev",
    "gcc-avr",
]

# What the stand-ins call themselves. platformio.ini asks for the official platforms; a test compares the two.
ATMELAVR_VERSION = "5.1.0+offline"
NATIVE_VERSION = "1.2.1+offline"

ARDUINO = Path("/usr/share/arduino/hardware/arduino/avr")


def ingredients() -> list[str | bytes]:
    """The changeable sources of a seeded directory: this program and Debian's versions."""
    sources = sorted(HERE.rglob("*.py"))
    return [*(path.read_bytes() for path in sources), json.dumps(debian_versions())]


def debian_versions() -> dict[str, str]:
    """The upstream versions of the Debian packages, as 5.4.0.

    Raises:
        KeyError: when used, if a package is not installed: the table lacks it.
    """
    show = ["dpkg-query", "--show", "--showformat=${Package} ${Version}\n", *DEBIAN_PACKAGES]
    lines = subprocess.run(show, capture_output=True, text=True, check=False).stdout.splitlines()
    return {package: upstream_version(version) for package, version in (line.split() for line in lines)}


def upstream_version(version: str) -> str:
    """1:5.4.0+Atmel3.6.2-3 -> 5.4.0; always three numbers."""
    found = re.match(r"(?:\d+:)?(\d+(?:\.\d+)*)", version)
    numbers = found.group(1).split(".") if found else []
    return ".".join([*numbers, "0", "0", "0"][:3])


def scons_release(requirement: str) -> str:
    """The release of SCons that PlatformIO's tool-scons requirement means: ~4.41101.0 -> 4.11.1.

    Raises:
        ValueError: the requirement is written in a way not known here.
    """
    found = re.fullmatch(r"~(\d+)\.\1(\d\d)(\d\d)\.0", requirement)
    if not found:
        raise ValueError(
            f"tool-scons {requirement}: not of the form ~4.41101.0. Pin the platformio of constraints.txt"
        )
    major, minor, patch = (int(part) for part in found.groups())
    return f"{major}.{minor}.{patch}"


def is_ours(local_ini: Path) -> bool:
    """Whether platformio.local.ini was written by this program."""
    try:
        return local_ini.read_text(encoding="utf-8").startswith(MARK)
    except OSError:
        return False


def write_local_ini(local_ini: Path) -> None:
    """Points PlatformIO to the seeded directory; platformio.ini pulls this file in.

    Raises:
        FileExistsError: a file of the user's own is there; the message says what to add to it.
    """
    if local_ini.exists() and not is_ours(local_ini):
        raise FileExistsError(
            f"{local_ini} is your own and is kept. Move it away, or add to its section [platformio] the line "
            f"core_dir = {CORE_DIR}"
        )
    text = f"""{MARK}, because the PlatformIO registry did not answer. Delete it and
; run `make setup` to ask again.
[platformio]
core_dir = {CORE_DIR}
; These two follow from it, but hold even where PLATFORMIO_CORE_DIR is set.
platforms_dir = {CORE_DIR}/platforms
packages_dir = {CORE_DIR}/packages
"""
    local_ini.write_text(text, encoding="utf-8")


class Seeder:
    """Makes one core directory, from nothing."""

    def __init__(self, core_dir: Path) -> None:
        from platformio import __version__
        from platformio.dependencies import get_core_dependencies

        self.core_dir = core_dir
        self.platformio_version: str = __version__
        self.requirements: dict[str, str] = get_core_dependencies()
        self.debian = debian_versions()

    def seed(self) -> None:
        """Replaces the content of the core directory.

        Raises:
            OSError: it cannot be written, or a file of a Debian package is missing.
            subprocess.CalledProcessError: pip could not fetch SCons.
        """
        shutil.rmtree(self.core_dir, ignore_errors=True)
        self.core_dir.mkdir(parents=True)
        self._settings()
        self._atmelavr()
        self._native()
        self._toolchain()
        self._framework()
        self._avrdude()
        self._cppcheck()
        self._scons()

    def _settings(self) -> None:
        """Turns off what PlatformIO would do on the network by itself, each of which can hang without one."""
        state = {
            "last_version": self.platformio_version,
            "settings": {
                "enable_telemetry": False,
                "check_platformio_interval": 36500,  # days
                "check_prune_system_threshold": 0,
            },
        }
        _write_json(self.core_dir / "appstate.json", state)

    def _atmelavr(self) -> None:
        folder = self.core_dir / "platforms" / "atmelavr"
        package = {"owner": "platformio", "version": "*"}
        manifest = {
            "name": "atmelavr",
            "title": "Atmel AVR (stand-in made of Debian's packages)",
            "version": ATMELAVR_VERSION,
            "frameworks": {
                "arduino": {"package": "framework-arduino-avr", "script": "builder/frameworks/arduino.py"}
            },
            "packages": {
                "toolchain-atmelavr": {**package, "type": "toolchain"},
                "framework-arduino-avr": {**package, "type": "framework", "optional": True},
                "tool-avrdude": {**package, "type": "uploader", "optional": True},
            },
        }
        _write_package(folder, "platform", manifest)
        _copy(BUILDERS / "atmelavr.py", folder / "builder" / "main.py")
        _copy(BUILDERS / "arduino.py", folder / "builder" / "frameworks" / "arduino.py")
        properties = parse_boards((ARDUINO / "boards.txt").read_text(encoding="utf-8"))
        _write_json(
            folder / "boards" / "megaatmega2560.json", board_manifest(properties, "mega", "atmega2560")
        )

    def _native(self) -> None:
        folder = self.core_dir / "platforms" / "native"
        manifest = {"name": "native", "title": "Native (stand-in)", "version": NATIVE_VERSION, "packages": {}}
        _write_package(folder, "platform", manifest)
        _copy(BUILDERS / "native.py", folder / "builder" / "main.py")

    def _toolchain(self) -> None:
        major, minor, patch = self.debian["gcc-avr"].split(".")
        folder = self._tool("toolchain-atmelavr", f"1.{int(major)}{int(minor):02}{int(patch):02}.0+debian")
        for program in sorted(Path("/usr/bin").glob("avr-*")):
            _link(program, folder / "bin" / program.name)

    def _framework(self) -> None:
        folder = self._tool("framework-arduino-avr", self.debian["arduino-core-avr"] + "+debian")
        for part in ("bootloaders", "cores", "libraries", "variants"):
            _link(ARDUINO / part, folder / part)

    def _avrdude(self) -> None:
        folder = self._tool("tool-avrdude", self.debian["avrdude"] + "+debian")
        _link(Path("/usr/bin/avrdude"), folder / "bin" / "avrdude")
        _link(Path("/etc/avrdude.conf"), folder / "avrdude.conf")

    def _cppcheck(self) -> None:
        wanted = self.requirements["tool-cppcheck"].removeprefix("~")
        folder = self._tool("tool-cppcheck", f"{wanted}+debian.{self.debian['cppcheck']}")
        _link(Path("/usr/bin/cppcheck"), folder / "cppcheck")

    def _scons(self) -> None:
        requirement = self.requirements["tool-scons"]
        folder = self._tool("tool-scons", requirement.removeprefix("~") + "+pypi")
        pip = [sys.executable, "-m", "pip", "-qq", "--disable-pip-version-check", "--no-input"]
        target = [
            "install",
            "--no-deps",
            "--target",
            str(folder / "lib"),
            f"scons=={scons_release(requirement)}",
        ]
        subprocess.run([*pip, *target], check=True, stdin=subprocess.DEVNULL)
        _copy(BUILDERS / "scons.py", folder / "scons.py")

    def _tool(self, name: str, version: str) -> Path:
        folder = self.core_dir / "packages" / name
        _write_package(folder, "tool", {"name": name, "version": version})
        return folder


def _write_package(folder: Path, kind: str, manifest: dict[str, Any]) -> None:
    name, version = manifest["name"], manifest["version"]
    _write_json(folder / ("platform.json" if kind == "platform" else "package.json"), manifest)
    spec = {"owner": "platformio", "id": None, "name": name, "requirements": None, "uri": None}
    _write_json(folder / ".piopm", {"type": kind, "name": name, "version": version, "spec": spec})


def _write_json(path: Path, content: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)


def _link(source: Path, target: Path) -> None:
    if not source.exists():
        raise FileNotFoundError(
            f"{source} is missing. Try: sudo apt-get install --reinstall {' '.join(DEBIAN_PACKAGES)}"
        )
    target.parent.mkdir(parents=True, exist_ok=True)
    target.symlink_to(source)


def main() -> int:
    """Seeds the directory named on the command line."""
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        Seeder(Path(sys.argv[1])).seed()
    except (OSError, KeyError, ValueError, subprocess.CalledProcessError) as error:
        print(f"offline.seed: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
