"""`tilenca sweep`: from the command line to the table."""

import json
import os
import shlex
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from support.machines import in_this_process
from support.sweeps import one_shape
from tilenca import cli
from tilenca.base import paths
from tilenca.simulator import core_library
from tilenca.sweep.table import read_parquet

needs_core = pytest.mark.skipif(
    not core_library.LIBRARY.exists(), reason="run `make setup` to compile the core"
)
needs_elf = pytest.mark.skipif(
    not paths.FIRMWARE_ELF.exists(), reason="run `make setup` to build the firmware"
)


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    """The address of a scheduler in this process, with one worker."""
    with in_this_process(workers=1) as address:
        yield address


def sweep(capsys: pytest.CaptureFixture[str], *words: str) -> Any:
    assert cli.main(["sweep", "--json", *words]) == 0
    return json.loads(capsys.readouterr().out)


WORDS = ("--axis", "loss=0,0.4", "--axis", "size=drawn,7x6", "--runs", "5", "--steps", "20", "--seed", "3")


@needs_core
def test_the_table_has_every_combination_and_each_row_can_be_measured_alone(
    scheduler: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    where = ("--scheduler", scheduler)
    report = sweep(
        capsys,
        *WORDS,
        "--shape",
        "4",
        "--shape",
        "7",
        *where,
        "--out",
        str(tmp_path / "all"),
        "--csv",
        "--plot",
    )
    names = ["table.parquet", "table.csv", "curves.svg", "times.svg"]
    assert report["files"] == [str(tmp_path / "all" / name) for name in names]
    assert report["rows"] == read_parquet(tmp_path / "all" / "table.parquet")[0]
    assert [(row["loss"], row["size"], row["shape"]) for row in report["rows"]] == [
        (loss, size, shape) for loss in (0.0, 0.4) for size in ("drawn", "7x6") for shape in ("4", "7", "all")
    ]
    assert {(row["runs"], row["seed"], row["steps"]) for row in report["rows"]} == {(5, 3, 20), (10, 3, 20)}
    for number in (4, 8):
        program, command, *words, out = shlex.split(report["rows"][number]["command"])
        assert (program, command, out) == ("tilenca", "sweep", "row")
        again = sweep(capsys, *words, str(tmp_path / f"row-{number}"), *where)["rows"][-1]
        own = {"command", *(["shape", "file"] if number == 8 else [])}
        assert {**again, **dict.fromkeys(own)} == {
            **report["rows"][number],
            **dict.fromkeys(own),
        }


@needs_core
def test_what_is_measured_is_not_measured_again(
    scheduler: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--axis", "loss=0.1", "--shape", "1", "--runs", "2", "--out", str(tmp_path))
    first = sweep(capsys, *words, "--scheduler", scheduler)
    assert sweep(capsys, *words, "--scheduler", "tcp://127.0.0.1:9") == first  # nobody is asked
    assert cli.main(["sweep", *words, "--seed", "2"]) == 2
    assert "holds a sweep with another --seed; give another --out" in capsys.readouterr().err


@needs_core
def test_the_printed_table_has_a_line_for_each_cell(
    scheduler: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["sweep", *WORDS, "--out", str(tmp_path), "--scheduler", scheduler]) == 0
    captured = capsys.readouterr()
    lines = captured.out.splitlines()
    assert lines[0].split()[:3] == ["loss", "size", "runs"]
    assert [line.split()[:3] for line in lines[1:5]] == [
        ["0", "drawn", "50"],
        ["0", "7x6", "50"],
        ["0.4", "drawn", "50"],
        ["0.4", "7x6", "50"],
    ]
    assert lines[5:] == [str(tmp_path / "table.parquet")]
    assert "4 cells, 40 drawings in them, 200 runs; 1 workers; " in captured.err
    assert "cell updates in" in captured.err


@needs_core
@needs_elf
def test_emulated_tiles_are_swept_in_the_same_words(
    scheduler: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--engine", "emulator", "--axis", "loss=0,1", "--shapes", str(one_shape(tmp_path)))
    more = ("--runs", "2", "--steps", "20", "--out", str(tmp_path / "out"), "--scheduler", scheduler)
    heard, unheard = sweep(capsys, *words, *more)["rows"]
    assert (heard["runs"], heard["right"], heard["delay"], heard["lost"]) == (2, 2, 0.0, None)
    assert unheard["cells_right"] <= heard["cells_right"]
    assert 1 <= heard["median"] <= 20


def test_ctrl_c_says_how_to_go_on_and_nothing_is_lost(tmp_path: Path) -> None:
    sweep = ["sweep", "--axis", "loss=0:0.48:0.02", "--shape", "8", "--runs", "60", "--csv"]
    words = [sys.executable, "-m", "tilenca.cli", *sweep]
    out = tmp_path / "stopped"
    running = subprocess.Popen(
        [*words, "--jobs", "1", "--out", str(out)], stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    assert running.stderr is not None
    said = [running.stderr.readline(), running.stderr.readline()]
    os.killpg(running.pid, signal.SIGINT)  # as a terminal does: to the workers, too
    said += running.stderr.readlines()
    assert running.wait(60) == 130, said
    assert "runs, 1 workers" in said[1]
    assert said[-1].startswith(f"tilenca: interrupted; {out} has ")
    assert said[-1].endswith(" of 1,500 runs; to go on, run the same command again\n")
    done = subprocess.run(
        [*words, "--jobs", "1", "--out", str(out)], capture_output=True, text=True, check=True
    )
    assert " of them measured before; " in done.stderr
    subprocess.run([*words, "--jobs", "2", "--out", str(tmp_path / "whole")], capture_output=True, check=True)
    for name in ("table.parquet", "table.csv"):
        assert (out / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


@pytest.mark.parametrize(
    ("words", "fact"),
    [
        (["--axis", "los=1"], "there is no axis 'los'"),
        (["--axis", "delay=1"], "engine fast cannot do it"),
        (
            ["--axis", "model=hex", "--model", "letters"],
            "--model does nothing with --axis model; leave it out",
        ),
        (["--shape", "x"], "no drawing 'x'"),
        (["--model", "nowhere"], "nowhere/model.json"),
    ],
)
def test_what_makes_no_sense_is_a_line_and_leaves_nothing(
    words: list[str], fact: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["sweep", *words, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert fact in error
    assert len(error.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_without_dask_a_line_says_what_to_install(tmp_path: Path) -> None:
    program = (
        "import sys; sys.modules['distributed'] = None; from tilenca import cli; "
        f"sys.exit(cli.main(['sweep', '--shape', '1', '--runs', '1', '--out', {str(tmp_path / 'out')!r}]))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == (
        "tilenca: this needs Dask distributed, which is not installed; run: make setup-train\n"
    )
