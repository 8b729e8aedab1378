"""The fleet tools on emulated tiles: stock bootloader, real avrdude, real firmware."""

import json
import os
import select
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from support.alone import alone
from support.intel_hex import image
from support.schemas import fits
from tilenca.base import paths

LIMIT_S = 120
# What each of the three comes to hear.
LINKS = {1: "--S-", 2: "N-S-", 3: "N---"}

# `rjmp .-2` at the reset vector: a program that does nothing for ever.
IDLE = image(b"\xff\xcf")


def tilenca(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "tilenca.cli", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=False)


@pytest.fixture(scope="module")
def served(firmware: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The pattern of the ports of a `1` of three emulated tiles."""
    folder = tmp_path_factory.mktemp("served") / "tiles"
    shapes = str(paths.SHAPES / "digits-3x3.toml")
    command = [
        sys.executable,
        "-m",
        "tilenca.cli",
        "emulate",
        "--shapes",
        shapes,
        "--shape",
        "1",
        "--elf",
        str(firmware),
        "--serve",
        str(folder),
    ]
    with subprocess.Popen(command, stderr=subprocess.PIPE, bufsize=0) as serving:
        assert serving.stderr is not None
        ready, _, _ = select.select([serving.stderr], [], [], LIMIT_S)
        said = os.read(serving.stderr.fileno(), 4096).decode() if ready else "nothing"
        assert "serving 3 tiles" in said, said
        yield f"{folder}/tile-*"
        serving.send_signal(signal.SIGINT)
        serving.communicate(timeout=LIMIT_S)


def monitored(served: str, *options: str) -> Iterator[dict[str, Any]]:
    """What the monitor hears after it has opened the ports, which resets the tiles."""
    command = [sys.executable, "-m", "tilenca.cli", "monitor", "--json", *options, "--port", served]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as monitor:
        try:
            assert monitor.stdout is not None
            for sentence in map(json.loads, monitor.stdout):
                assert fits("monitor", sentence)
                yield sentence
        finally:
            monitor.send_signal(signal.SIGINT)


def flash(served: str, firmware: Path) -> None:
    done = tilenca("flash", "--json", "--hex", str(firmware), "--port", served)
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert fits("flash", document)
    results = document["tiles"]
    assert [(Path(tile["port"]).name, tile["result"]) for tile in results] == [
        (f"tile-0{number}", "flashed") for number in (1, 2, 3)
    ]


def test_devices_lists_served_tiles(served: str) -> None:
    done = tilenca("devices", "--json", "--port", served)
    assert done.returncode == 0, done.stderr
    assert fits("devices", json.loads(done.stdout))
    assert [Path(device["port"]).name for device in json.loads(done.stdout)["devices"]] == [
        "tile-01",
        "tile-02",
        "tile-03",
    ]


def test_tiles_are_programmed_side_by_side_and_run_what_was_written(
    served: str, firmware: Path, tmp_path: Path
) -> None:
    idle = tmp_path / "idle.hex"
    idle.write_text(IDLE)
    flash(served, idle)
    assert list(monitored(served, "--seconds", "2")) == [], "the idle program says nothing"
    flash(served, firmware.with_suffix(".hex"))
    first: dict[int, str] = {}
    missing = {(tile, kind) for tile in LINKS for kind in ("LINK", "TIME", LINKS[tile])}
    for sentence in monitored(served):
        tile, kind = sentence["tile"], sentence["type"]
        assert sentence["port"].endswith(f"tile-0{tile}")
        first.setdefault(tile, kind)
        missing.discard((tile, sentence["fields"]["links"] if kind == "TILE" else kind))
        if not missing:
            break
    assert set(first.values()) == {"HELLO"}, "the ports' opening has reset them"


def test_a_models_own_firmware_is_built_and_written_and_the_projects_stays(
    served: str, firmware: Path, tmp_path: Path
) -> None:
    model, before = tmp_path / "hex", {p: p.read_bytes() for p in paths.FIRMWARE.rglob("*") if p.is_file()}
    shutil.copytree(paths.MODELS / "hex", model)
    model_id = json.loads((model / "model.json").read_text(encoding="utf-8"))["model_id"]
    for result in ("flashed", "skipped"):
        with alone("platformio"):
            done = tilenca("flash", "--json", "--model", str(model), "--port", served)
        assert done.returncode == 0, done.stderr
        assert [tile["result"] for tile in json.loads(done.stdout)["tiles"]] == [result] * 3
    hello = next(sentence for sentence in monitored(served) if sentence["type"] == "HELLO")
    assert hello["fields"]["model_id"] == model_id
    assert {p: p.read_bytes() for p in paths.FIRMWARE.rglob("*") if p.is_file()} == before
    flash(served, firmware.with_suffix(".hex"))  # as the other tests expect them
