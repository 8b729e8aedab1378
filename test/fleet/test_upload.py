"""PlatformIO's own commands on a tile: real firmware, the stock bootloader, real avrdude."""

import os
import pty
import subprocess
import sys
from pathlib import Path

from support.alone import alone
from support.lab import Lab
from support.terminal import read_until
from tilenca.base import paths

# Only a hang takes so long.
LIMIT_S = 1200


def test_platformio_uploads_to_one_tile_and_monitors_it(lone_tile: Lab) -> None:
    pio = Path(sys.executable).with_name("pio")
    port = lone_tile.port(1)
    with alone("pio"):
        uploaded = subprocess.run(
            [pio, "run", "-e", paths.FIRMWARE_ENV, "-t", "upload", "--upload-port", port],
            cwd=paths.ROOT,
            capture_output=True,
            text=True,
            timeout=LIMIT_S,
            check=False,
        )
    assert uploaded.returncode == 0, uploaded.stderr
    assert "bytes of flash verified" in uploaded.stderr
    keyboard, inside = pty.openpty()
    monitor = subprocess.Popen(
        [pio, "device", "monitor", "--port", port, "-f", "direct"],
        cwd=paths.ROOT,
        stdin=inside,
        stdout=inside,
        stderr=inside,
    )
    read_until(keyboard, "$TILE,1,")
    os.write(keyboard, b"\x03")
    monitor.wait(LIMIT_S)
    os.close(inside)
    os.close(keyboard)
