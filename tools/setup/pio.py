"""PlatformIO: by its own registry where that answers, by the stand-ins of tools/offline where it does not."""

import os
import subprocess
import time
from collections.abc import Sequence
from pathlib import Path

from offline import seed
from setup.command import ROOT, SetupError, Stamp, digest, run, say
from setup.native import install_system_packages
from setup.python import PYTHON, VENV, installed_version

LOCAL_INI = ROOT / "platformio.local.ini"
CORE_DIR = ROOT / seed.CORE_DIR
PROBE = ROOT / "tools" / "offline" / "probe.py"

# The probe's own limit is on the network alone; this one is for the case that even Python does not start.
PROBE_LIMIT_S = 30
# The limit for downloading PlatformIO's packages, some 50 MB.
OFFICIAL_LIMIT_S = 600


def make_ready() -> None:
    """Makes PlatformIO able to build, test and upload, with or without a network.

    Once seeded, a clone stays seeded until platformio.local.ini is deleted: no question to the network again.

    Raises:
        SetupError: neither way works.
    """
    version = installed_version("platformio") or "none"
    official = Stamp(VENV / ".tilenca-platformio", digest([version, (ROOT / "platformio.ini").read_bytes()]))
    if seed.is_ours(LOCAL_INI):
        _seed_if_changed(version)
    elif not official.is_current():
        if _registry_answers() and _install_official():
            official.set()
        else:
            say("PlatformIO's registry does not answer: using stand-ins made of Debian's packages")
            _seed_if_changed(version)


def _registry_answers() -> bool:
    say("asking whether PlatformIO's registry answers")
    return _succeeds([PYTHON, PROBE], PROBE_LIMIT_S)


def _install_official() -> bool:
    say("installing PlatformIO's packages for the board")
    return _succeeds([VENV / "bin" / "pio", "pkg", "install"], OFFICIAL_LIMIT_S)


def _succeeds(command: Sequence[str | Path], limit_s: float) -> bool:
    """Whether a command ends well and in time; it is killed otherwise."""
    try:
        done = subprocess.run(command, cwd=ROOT, stdin=subprocess.DEVNULL, timeout=limit_s, check=False)
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def _seed_if_changed(version: str) -> None:
    install_system_packages(seed.DEBIAN_PACKAGES)
    stamp = Stamp(CORE_DIR / ".seeded", digest([version, *seed.ingredients()]))
    if stamp.is_current() and seed.is_ours(LOCAL_INI):
        return
    started = time.monotonic()
    stamp.clear()
    tools = {**os.environ, "PYTHONPATH": str(ROOT / "tools")}
    run([PYTHON, "-m", "offline.seed", CORE_DIR], "the stand-ins for PlatformIO cannot be made", tools)
    try:
        seed.write_local_ini(LOCAL_INI)
    except FileExistsError as error:
        raise SetupError(str(error)) from error
    stamp.set()
    say(f"PlatformIO is ready without its registry ({time.monotonic() - started:.0f} s)")
