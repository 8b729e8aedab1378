"""Building the firmware before it is written."""

import os
import shutil
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import BuildError
from tilenca.base.project import install_remedy, project
from tilenca.base.signals import held_back
from tilenca.base.stdio import warn

CANCELLED = "the build was cancelled"
LOOK_S = 0.1


def build(sources: Path | None = None, quiet: bool = False, cancelled: threading.Event | None = None) -> None:
    """Builds the project's firmware unless it is up to date. Shows the build's output only if it fails.

    Args:
        sources: a folder with `include` and `src` to build instead of the project's, in its folder `build`.
        quiet: do not say that it builds.
        cancelled: ends the build, with all processes that it has started, as soon as it is set.

    Raises:
        BuildError: there is no project, PlatformIO is missing, or the build failed or was cancelled.
    """
    folder = project()
    beside = Path(sys.executable).with_name("pio")
    pio = str(beside) if beside.exists() else shutil.which("pio")
    if pio is None:
        raise BuildError(
            f"PlatformIO is not installed; run: {install_remedy('firmware')}, or name an image with --hex"
        )
    if not quiet:
        warn("building the firmware")
    command = [pio, "run", "-e", paths.FIRMWARE_ENV]
    elsewhere = {
        f"PLATFORMIO_{part.upper()}_DIR": str(sources.resolve() / part)
        for part in ("include", "src", "build")
        if sources is not None
    }
    building: subprocess.Popen[bytes] | None = None
    try:
        with held_back():
            # A process group of its own: the processes that the build starts end with it.
            building = subprocess.Popen(
                command,
                cwd=folder,
                env=os.environ | elsewhere,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                process_group=0,
            )
        output = _output(building, cancelled)
    except BaseException:
        if building is not None:
            with suppress(ProcessLookupError):
                os.killpg(building.pid, signal.SIGKILL)
            building.communicate()
        raise
    if building.returncode != 0:
        warn(output.decode("utf-8", "replace").rstrip("\n"))
        raise BuildError(
            f"`{' '.join(command)}` failed with status {building.returncode}; its output is above"
        )


def _output(building: subprocess.Popen[bytes], cancelled: threading.Event | None) -> bytes:
    """Waits for a build to end; returns what it has printed."""
    while True:
        try:
            return building.communicate(timeout=None if cancelled is None else LOOK_S)[0]
        except subprocess.TimeoutExpired:
            if cancelled is not None and cancelled.is_set():
                raise BuildError(CANCELLED) from None
