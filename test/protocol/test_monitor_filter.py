"""`pio device monitor` with the project's filter: on bytes, and on a served emulated tile."""

import importlib.util
import os
import pty
import select
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from tilenca.base import paths
from tilenca.protocol.sentences import NakSentence, TileSentence, format_sentence

FILTER = paths.ROOT / "monitor" / "filter_tilenca.py"
PIO = Path(sys.executable).with_name("pio")
TILE = TileSentence(7, 1200, 12, "4", 4, 30, "N-SW", bytes([128]) * 21)
LIMIT_S = 60


@pytest.fixture
def decoder() -> Any:
    spec = importlib.util.spec_from_file_location("filter_tilenca", FILTER)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.Tilenca({"project_dir": str(paths.ROOT)})


def test_sentences_become_words_however_they_are_cut(decoder: Any) -> None:
    stream = (format_sentence(TILE) + format_sentence(NakSentence(7, "VALUE", "SET"))).decode()
    shown = "".join(decoder.rx(character) for character in stream + "$")
    assert shown == (
        "tile 7 TILE shows 4 margin 30 update 12 up 1.2 s links N-SW\r\ntile 7 NAK SET: wrong field\r\n"
    )


def test_damaged_lines_are_shown_and_the_next_is_read(decoder: Any) -> None:
    line = format_sentence(TILE).decode()
    shown = decoder.rx(line + line.replace("N-SW", "N\ufffdSW") + line + "$")
    good, damaged, again = shown.splitlines()
    assert damaged.startswith("DAMAGED $TILE,7,1200,12,4,4,30,N?SW")
    assert good == again == "tile 7 TILE shows 4 margin 30 update 12 up 1.2 s links N-SW"


def test_what_the_board_test_says_passes_whole(decoder: Any) -> None:
    line = "side N: FAIL, heard nothing: no plug, no tile, or a broken line to PD2\r\n"
    shown = "".join(decoder.rx(character) for character in line + "butt\ufffdn: open\r\n" + line)
    assert shown == f"{line}DAMAGED butt?n: open\r\n{line}"


def test_it_is_the_filter_that_the_project_asks_for(decoder: Any) -> None:
    assert decoder.NAME == "tilenca"
    assert f"monitor_filters = {decoder.NAME}\n" in (paths.ROOT / "platformio.ini").read_text()
    assert decoder.tx("typed") == "typed"


def read_until(descriptor: int, wanted: bytes) -> bytes:
    """Everything a terminal showed until `wanted` was among it."""
    shown, end_s = b"", time.monotonic() + LIMIT_S
    while wanted not in shown:
        ready, _, _ = select.select([descriptor], [], [], max(0.0, end_s - time.monotonic()))
        assert ready, f"{wanted!r} is not among {shown!r}"
        shown += os.read(descriptor, 4096)
    return shown


@pytest.mark.skipif(not PIO.exists(), reason="PlatformIO is not installed; run `make setup`")
def test_pio_device_monitor_shows_a_served_tile_in_words(tmp_path: Path) -> None:
    tiles = tmp_path / "tiles"
    serve = [sys.executable, "-m", "tilenca.cli", "emulate", "--shape", "1", "--serve", str(tiles)]
    with subprocess.Popen([*serve, "--bootloader", "none"], stderr=subprocess.PIPE, bufsize=0) as serving:
        assert serving.stderr is not None
        read_until(serving.stderr.fileno(), b"serving 5 tiles")
        master, slave = pty.openpty()
        command = [str(PIO), "device", "monitor", "-d", str(paths.ROOT), "-e", paths.FIRMWARE_ENV]
        port = ["-p", str((tiles / "tile-01").resolve())]
        with subprocess.Popen([*command, *port], stdin=slave, stdout=slave, stderr=slave) as monitor:
            try:
                shown = read_until(master, b"tile 1 TIME computes")
                assert b"tile 1 HELLO protocol 3 firmware" in shown
                assert b"tile 1 LINK N sent" in shown
                assert b"$TILE" not in shown
            finally:
                monitor.send_signal(signal.SIGTERM)
                monitor.wait(LIMIT_S)
                serving.send_signal(signal.SIGINT)
                serving.communicate(timeout=LIMIT_S)
                os.close(master)
                os.close(slave)
