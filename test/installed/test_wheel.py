"""The wheel in an empty environment and an empty folder: all that needs no compiler works there."""

import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any, BinaryIO

import pytest
from elftools.elf.elffile import ELFFile
from elftools.elf.sections import NoteSection
from packaging.requirements import Requirement

from release.wheel import make
from setup import native
from support import objects
from support.empty_environment import EmptyEnvironment
from support.web_socket import WebSocketClient, get
from tilenca import __version__
from tilenca.base import paths

TWO_TILES = '[[shape]]\nlabel = "1"\ngrid = """\n##\n"""\n'
MAX_BYTES = 3_000_000
PIO = Path(sys.executable).with_name("pio")


def names(wheel: Path) -> set[str]:
    """Its files."""
    return {name for name in zipfile.ZipFile(wheel).namelist() if not name.endswith("/")}


def requirements(wheel: Path, extra: str) -> list[str]:
    """What the wheel says that it depends on, with an extra of its own."""
    [metadata] = [name for name in names(wheel) if name.endswith(".dist-info/METADATA")]
    with zipfile.ZipFile(wheel) as archive:
        lines = archive.read(metadata).decode().partition("\n\n")[0].splitlines()
    given = [
        Requirement(text.removeprefix("Requires-Dist: "))
        for text in lines
        if text.startswith("Requires-Dist")
    ]
    return [one.name for one in given if one.marker is None or one.marker.evaluate({"extra": extra})]


@pytest.fixture(scope="module")
def wheel() -> Path:
    return make()[1]


@pytest.fixture(scope="module")
def plain(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> EmptyEnvironment:
    """Without any extra."""
    return EmptyEnvironment(tmp_path_factory.mktemp("plain"), wheel, requirements(wheel, ""))


@pytest.fixture(scope="module")
def training(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> EmptyEnvironment:
    """With the extra `train`."""
    return EmptyEnvironment(tmp_path_factory.mktemp("training"), wheel, requirements(wheel, "train"))


def document(done: "subprocess.CompletedProcess[str]") -> Any:
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_any_python_3_on_any_linux_of_its_age_takes_it_and_it_is_small(wheel: Path) -> None:
    assert re.fullmatch(rf"tilenca-{re.escape(__version__)}-py3-none-manylinux_2_\d+_\w+\.whl", wheel.name)
    assert wheel.stat().st_size < MAX_BYTES


def test_it_carries_the_data_and_nothing_by_the_way(wheel: Path) -> None:
    carried = {name for name in names(wheel) if ".dist-info/" not in name}
    checkout = {str(path.relative_to(paths.ROOT)) for path in paths.SHAPES.glob("*.toml")}
    for model in paths.MODELS.iterdir():
        checkout |= {
            str(path.relative_to(paths.ROOT))
            for path in model.iterdir()
            if path.is_file() and path.suffix != ".png"
        }
    for part in ("include", "src"):
        files = (path for path in (paths.FIRMWARE / part).rglob("*") if path.is_file())
        checkout |= {str(path.relative_to(paths.ROOT)) for path in files}
    checkout |= {str(path.relative_to(paths.ROOT)) for path in paths.PAGE.rglob("*") if path.is_file()}
    image = {"image/firmware.elf", "image/firmware.hex"}
    data = {name.removeprefix("tilenca/data/") for name in carried if name.startswith("tilenca/data/")}
    assert data == checkout | image | {"platformio.ini"}
    others = {name for name in carried if not name.startswith(("tilenca/data/", "tilenca/lib/"))}
    package = {
        path for path in paths.PACKAGE.rglob("*") if path.is_file() and path.parent.name != "__pycache__"
    }
    assert others == {str(path.relative_to(paths.PACKAGE.parent)) for path in package}
    libraries = {name.removeprefix("tilenca/lib/") for name in carried if name.startswith("tilenca/lib/")}
    assert {"libtilenca_emulator.so", "libtilenca_simulator.so", "libtilenca_rollout.so"} <= libraries
    assert {"include/tilenca/emulator.h", "include/tilenca/api.h"} <= libraries
    with zipfile.ZipFile(wheel) as archive:
        for suffix in (".elf", ".hex"):
            built = paths.FIRMWARE_ELF.with_suffix(suffix).read_bytes()
            assert archive.read(f"tilenca/data/image/firmware{suffix}") == built


def build_id(library: BinaryIO) -> str:
    """The linker's sum of a library's content; what is stripped from it later does not change it."""
    section = ELFFile(library).get_section_by_name(".note.gnu.build-id")
    assert isinstance(section, NoteSection)
    [note] = section.iter_notes()
    return str(note["n_desc"])


def test_its_libraries_are_those_of_the_checkout(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        for name in ("emulator", "simulator", "rollout"):
            file = f"libtilenca_{name}.so"
            carried = io.BytesIO(archive.read(f"tilenca/lib/{file}"))
            with (native.BUILD / file).open("rb") as built:
                assert build_id(carried) == build_id(built)


def test_without_the_firmware_no_wheel_is_built(tmp_path: Path) -> None:
    shutil.copy(paths.ROOT / "CMakeLists.txt", tmp_path)
    done = subprocess.run(
        ["cmake", "-S", tmp_path, "-B", tmp_path / "build", "-DSKBUILD=2"],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode != 0
    assert "build the wheel with `make wheel`" in " ".join(done.stderr.split())


def test_it_knows_its_version_and_no_checkout(plain: EmptyEnvironment, tmp_path: Path) -> None:
    assert plain.run(tmp_path, "tilenca", "--version").stdout == f"tilenca {__version__}\n"
    program = (
        "import importlib.metadata\nfrom tilenca.base import paths\n"
        "print(importlib.metadata.version('tilenca'), paths.CHECKOUT, paths.PROJECT, paths.PACKAGE)"
    )
    told = plain.run(tmp_path, "python", "-c", program).stdout.split()
    assert told[:3] == [__version__, "None", "None"]
    assert Path(told[3]).is_relative_to(plain.venv)


def test_tiles_agree_and_what_they_said_is_replayed(plain: EmptyEnvironment, tmp_path: Path) -> None:
    done = plain.run(tmp_path, "tilenca", "emulate", "--shape", "4", "--json", "--record", "said.jsonl")
    assert document(done)["all_right"]
    replayed = plain.run(tmp_path, "tilenca", "monitor", "--replay", "said.jsonl", "--speed", "0", "--json")
    assert replayed.returncode == 0, replayed.stderr
    said = [json.loads(line) for line in replayed.stdout.splitlines()]
    recorded = (tmp_path / "said.jsonl").read_text(encoding="utf-8").splitlines()
    assert len(said) == len([line for line in recorded if '"raw"' in line]) > 100


def test_a_model_is_simulated_and_measured(plain: EmptyEnvironment, tmp_path: Path) -> None:
    done = plain.run(tmp_path, "tilenca", "simulate", "--shape", "4", "--runs", "3", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout.splitlines()[0])
    by_name = ["simulate", "--model", "hex", "--shapes", "hex", "--shape", "A", "--runs", "3", "--json"]
    assert document(plain.run(tmp_path, "tilenca", *by_name))["file"] == "hex.toml"
    report = document(plain.run(tmp_path, "tilenca", "evaluate", "--runs", "3", "--json"))
    assert report["cells_right"] > 0.9
    (tmp_path / "one.toml").write_text(TWO_TILES, encoding="utf-8")
    emulated = ["evaluate", "--engine", "emulator", "--shapes", "one.toml", "--steps", "5", "--json"]
    assert document(plain.run(tmp_path, "tilenca", *emulated))["engine"] == "emulator"
    assert document(plain.run(tmp_path, "tilenca", "export", "--plan", "--json"))["fits"]


def test_what_is_not_there_is_one_line_with_its_remedy(plain: EmptyEnvironment, tmp_path: Path) -> None:
    for words, status, remedy in (
        (["plot", "--film", "4.png", "--shape", "4"], 2, "run: pip install 'tilenca[plot]'"),
        (["train", "--out", "mine"], 2, "run: pip install 'tilenca[train]'"),
        (["evaluate", "--engine", "float"], 2, "run: pip install 'tilenca[train]'"),
        (["page", "--no-open"], 2, "run: pip install 'tilenca[page]'"),
        (["export"], 4, "make one: tilenca new DIR, then cd DIR"),
        (["devices", "--port", "none-*"], 3, ""),
        (["emulate", "--elf", "none.elf"], 2, "run `pio run`, or give --elf"),
    ):
        done = plain.run(tmp_path, "tilenca", *words)
        assert done.returncode == status, (words, done.stderr)
        assert len(done.stderr.splitlines()) == 1, done.stderr
        assert done.stderr.rstrip("\n").endswith(remedy)
        assert "make setup" not in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_the_built_in_image_is_flashed_without_a_project(plain: EmptyEnvironment, tmp_path: Path) -> None:
    avrdude = shutil.which("avrdude")
    assert avrdude, "avrdude is not installed; run `make setup`"
    (tmp_path / "one.toml").write_text(TWO_TILES, encoding="utf-8")
    serve = ["emulate", "--shapes", "one.toml", "--serve", "tiles"]
    serving = subprocess.Popen(
        [plain.venv / "bin" / "tilenca", *serve],
        cwd=tmp_path,
        env=plain.environment(),
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        watched = plain.run(tmp_path, "tilenca", "monitor", "--port", "tiles/*", "--seconds", "0.5")
        assert watched.returncode == 0, watched.stderr  # it waits until they are there
        flash = ["tilenca", "flash", "--port", "tiles/tile-01", "--json"]
        done = plain.run(tmp_path, *flash)
        assert done.returncode == 1
        assert done.stderr.splitlines()[-1].startswith("tilenca: avrdude is not installed; ")
        with_avrdude = plain.environment(avrdude)
        done = plain.run(tmp_path, *flash, "--force", environment=with_avrdude)
        assert [tile["result"] for tile in document(done)["tiles"]] == ["flashed"], done.stderr
        assert str(plain.venv) in done.stderr  # the image's place
        done = plain.run(tmp_path, *flash, environment=with_avrdude)
        assert [tile["result"] for tile in document(done)["tiles"]] == ["skipped"], done.stderr
    finally:
        serving.send_signal(signal.SIGTERM)
        serving.communicate(timeout=60)


def test_with_its_extra_it_serves_the_page(wheel: Path, tmp_path: Path) -> None:
    paged = EmptyEnvironment(tmp_path / "paged", wheel, requirements(wheel, "page"))
    serving = subprocess.Popen(
        [paged.venv / "bin" / "tilenca", "page", "--no-open", "--listen", "127.0.0.1:0"],
        cwd=tmp_path,
        env=paged.environment(),
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert serving.stdout is not None
        host, _, port = serving.stdout.readline().strip().removeprefix("http://").rstrip("/").partition(":")
        address = (host, int(port))
        assert get(address, "/index.html").read() == (paths.PAGE / "index.html").read_bytes()
        assert (paths.PAGE / "main.js").read_bytes().splitlines()[-1] in get(address, "/main.js").read()
        client = WebSocketClient(address)
        first = client.watch("stream")
        assert first["drawings"][0]["name"] == "digits/0"
        client.send({"do": "open", "cells": [[0, 0]], "spread_s": 0})
        assert client.watch("raw")["raw"].startswith("$HELLO")
        client.close()
    finally:
        serving.send_signal(signal.SIGTERM)
        serving.communicate(timeout=60)


def test_a_picture_of_a_built_in_model_goes_into_this_folder(
    training: EmptyEnvironment, tmp_path: Path
) -> None:
    done = training.run(tmp_path, "tilenca", "plot", "--json")
    assert json.loads(done.stdout)["file"] == "history.png"
    assert (tmp_path / "history.png").exists()


def test_with_its_extra_it_plots(training: EmptyEnvironment, tmp_path: Path) -> None:
    done = training.run(tmp_path, "tilenca", "plot", "--film", "four.png", "--shape", "4")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "four.png").stat().st_size > 1000


def pio_environment() -> dict[str, str]:
    """PlatformIO comes from the tests' environment, and so do its packages."""
    environment = os.environ | objects.environment()
    if (paths.ROOT / "platformio.local.ini").exists():
        environment["PLATFORMIO_CORE_DIR"] = str(paths.BUILD / "platformio")
    return environment


@pytest.mark.skipif(not PIO.exists(), reason="PlatformIO is not installed; run `make setup`")
def test_a_project_of_ones_own_goes_from_drawings_to_tiles(
    training: EmptyEnvironment, tmp_path: Path
) -> None:
    made = document(training.run(tmp_path, "tilenca", "new", "mine", "--json"))
    project = Path(made["project"])
    assert project == tmp_path / "mine"
    shapes, model = ["--shapes", "shapes/mine.toml"], ["--model", "models/mine"]
    train = ["train", *shapes, "--out", "models/mine", "--recipe", "smoke", "--json"]
    trained = document(training.run(project, "tilenca", *train))
    assert trained["model"] == "models/mine"
    about = json.loads((project / "models" / "mine" / "model.json").read_text(encoding="utf-8"))
    assert about["metadata"]["commit"] == f"tilenca {__version__}"
    assert about["metadata"]["shapes"] == ["shapes/mine.toml"]
    measure = ["evaluate", *model, *shapes, "--engine", "emulator", "--steps", "5", "--json"]
    before = training.run(project, "tilenca", *measure)
    assert before.returncode == 4  # the digits are what is there
    assert "has no build yet" in before.stderr
    exported = document(training.run(project, "tilenca", "export", *model, "--json"))
    assert [Path(name).is_relative_to(project) for name in exported["files"]] == [True, True]
    build = [str(PIO), "run", "-s"]
    built = subprocess.run(
        build, cwd=project, env=pio_environment(), capture_output=True, text=True, timeout=600, check=False
    )
    assert built.returncode == 0, built.stderr
    assert document(training.run(project, "tilenca", *measure))["model"] == exported["model_id"]
    emulated = training.run(project / "shapes", "tilenca", "emulate", "--shapes", "mine.toml", "--json")
    assert emulated.returncode in (0, 1)  # so short a training may be wrong
    assert [run["shape"] for run in json.loads(emulated.stdout)["runs"]] == ["L", "t"]
    assert "digits" not in emulated.stderr
