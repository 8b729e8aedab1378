"""`tilenca simulate`: what it prints, and what it refuses."""

import json
import os
import re
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tilenca import cli
from tilenca.base import paths
from tilenca.commands.simulate import picture_of
from tilenca.shapes.file import Shape, load_task
from tilenca.shapes.glyphs import GLYPHS, look_of

WALL = ("seconds", "updates_per_second")


def simulate(capsys: pytest.CaptureFixture[str], *words: str) -> Any:
    assert cli.main(["simulate", "--json", *words]) == 0
    return json.loads(capsys.readouterr().out)


def without_wall_times(report: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in report.items() if key not in WALL}


def test_one_shape_is_one_document(capsys: pytest.CaptureFixture[str]) -> None:
    report = simulate(capsys, "--shape", "4", "--runs", "30")
    assert (report["shape"], report["file"], report["tiles"]) == ("4", "digits.toml", 10)
    assert (report["steps"], report["runs"]) == (60, 30)
    assert report["total_agreement"] >= 0.95
    assert report["cells_right"] >= report["total_agreement"]
    assert 2 <= report["steps_to_agreement"]["median"] <= 20
    assert report["shown"]["4"] == report["cells_right"]
    # 60 steps, and up to ten before the last tile is switched on.
    assert 30 * 10 * 60 < report["cell_updates"] < 30 * 10 * 70
    assert report["updates_per_second"] == pytest.approx(report["cell_updates"] / report["seconds"], rel=1e-2)


def test_several_shapes_are_one_document_too(capsys: pytest.CaptureFixture[str]) -> None:
    files = [str(paths.SHAPES / name) for name in ("digits.toml", "digits-3x3.toml")]
    report = simulate(
        capsys, "--shapes", *files, "--shape", "1", "--shape", "0", "--runs", "2", "--steps", "5"
    )
    found = [(shape["shape"], shape["file"]) for shape in report["shapes"]]
    assert found == [
        ("0", "digits.toml"), ("1", "digits.toml"), ("0", "digits-3x3.toml"), ("1", "digits-3x3.toml")
    ]  # fmt: skip
    assert report["cell_updates"] == sum(shape["cell_updates"] for shape in report["shapes"])


def test_the_same_seed_gives_the_same_runs_on_any_number_of_threads(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = (
        "--shape",
        "8",
        "--runs",
        "300",
        "--steps",
        "6",
        "--loss",
        "0.2",
        "--lost",
        "zero",
        "--dead",
        "0.1",
    )
    one, three, other = (
        without_wall_times(simulate(capsys, *words, "--threads", threads, "--seed", seed))
        for threads, seed in (("1", "5"), ("3", "5"), ("1", "6"))
    )
    assert one == three
    assert one != other


def test_ten_thousand_tiles_in_one_array(capsys: pytest.CaptureFixture[str]) -> None:
    report = simulate(capsys, "--array", "100x100", "--steps", "3", "--schedule", "random")
    assert (report["shape"], report["tiles"], report["runs"]) == ("100x100", 10_000, 1)
    assert report["cells_right"] is report["total_agreement"] is report["steps_to_agreement"] is None
    assert 29_000 < report["cell_updates"] < 31_000
    assert 0.9 < sum(report["shown"].values()) <= 1.0


@pytest.mark.parametrize(
    ("words", "note", "result"),
    [
        (("simulate", "--array", "30x30", "--steps", "1"), b"1 of 1 step", b"after 1 step they show"),
        (("emulate", "--shape", "1", "--seconds", "0.2"), b"0.20 s emulated", b"5 tiles, 0.2 s emulated"),
    ],
)
def test_a_terminal_is_told_how_far_it_is(words: tuple[str, ...], note: bytes, result: bytes) -> None:
    master, slave = os.openpty()
    command = [sys.executable, "-m", "tilenca.cli", *words]
    terminal = os.environ | {"TERM": "xterm"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=slave, env=terminal) as process:
        os.close(slave)
        shown = b""
        with suppress(OSError):  # as the other end is closed
            while data := os.read(master, 4096):
                shown += data
        printed, _ = process.communicate(timeout=60)
    os.close(master)
    assert note in re.sub(rb"\x1b\[[0-9;]*m", b"", shown)
    assert result in printed


def test_a_pipe_gets_no_bars() -> None:
    command = [sys.executable, "-m", "tilenca.cli", "simulate", "--array", "30x30", "--steps", "1"]
    assert subprocess.run(command, capture_output=True, timeout=60, check=True).stderr == b""


def test_text_has_a_line_for_each_shape_and_the_speed(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["simulate", "--runs", "2", "--steps", "9", "--threads", "1"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[:-1]] == ["shape", *"0123456789"]
    assert "million per second; threads: at most 1" in lines[-1]
    assert cli.main(["simulate", "--array", "4x5", "--steps", "9"]) == 0
    assert capsys.readouterr().out.startswith("4x5: 20 tiles; after 9 steps they show ")


def test_without_a_terminal_watching_tells_every_change(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["simulate", "--shape", "1", "--watch", "--steps", "30"]) == 0
    *lines, last = capsys.readouterr().out.splitlines()
    shows = {}
    for line in lines:
        words = line.split()
        assert words[0] == "step"
        assert words[2:4] == ["1:", "tile"]
        shows[words[4]] = words[6]
    assert shows == dict.fromkeys("12345", "1")
    assert last == "1: 100% of the living tiles show 1 after 30 steps"


def test_a_picture_has_the_glyph_and_colour_of_each_class_and_dark_tiles() -> None:
    task = load_task(paths.DEFAULT_SHAPES)
    picture = picture_of(task.find("1"), task.labels, np.array([1, 1, -1, 7, 0], np.int8))
    assert picture.segments == (GLYPHS["1"], GLYPHS["1"], 0, GLYPHS["7"], GLYPHS["0"])
    assert picture.colours[2] == (0, 0, 0)
    assert picture.colours[3] == look_of("7", 7).colour


def test_a_picture_has_the_colours_of_the_tiles_whatever_the_order_of_the_classes() -> None:
    shape = Shape("7", ("##",), "7")
    picture = picture_of(shape, ("7", "1"), np.array([0, 1], np.int8))
    assert picture.segments == (GLYPHS["7"], GLYPHS["1"])
    assert picture.colours == ((55, 0, 0), (0, 20, 0)), "red and green, as the tiles show these digits"


@pytest.mark.parametrize(
    "words",
    [
        ["--array", "0x3"],
        ["--array", "100"],
        ["--array", "1001x1"],
        ["--array", "3x3", "--shape", "4"],
        ["--array", "3x3", "--watch"],
        ["--array", "3x3", "--shapes", "shapes/digits.toml"],
        ["--shape", "nothing"],
        ["--watch", "--json"],
        ["--watch", "--runs", "2"],
        ["--runs", "0"],
        ["--steps", "0"],
        ["--threads", "0"],
        ["--loss", "1.1"],
        ["--dead", "-1"],
        ["--seed", "-1"],
        ["--schedule", "never"],
        ["--model", "nowhere"],
        ["--shapes", "nothing.toml"],
    ],
)
def test_what_makes_no_sense_is_one_line(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    try:
        status: Any = cli.main(["simulate", *words])
    except SystemExit as end:
        status = end.code
    assert status == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert len(printed.err.strip().splitlines()) == 1


def test_a_label_the_model_does_not_know_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shapes = tmp_path / "letter.toml"
    shapes.write_text('[[shape]]\nlabel = "H"\ngrid = """\n#.#\n###\n#.#\n"""\n')
    assert cli.main(["simulate", "--shapes", str(shapes)]) == 2
    assert "does not know 'H'" in capsys.readouterr().err


def test_a_model_brings_its_own_shapes_and_a_mistyped_one_is_answered(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ["simulate", "--model", str(paths.MODELS / "letters"), "--runs", "1", "--steps", "2"]
    assert cli.main([*words, "--shape", "L", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["file"] == "letters.toml"
    assert cli.main([*words, "--shape", "LL"]) == 2
    assert "no shape 'LL' (did you mean 'L'?)" in capsys.readouterr().err
