"""tilenca train: what it writes, says and refuses."""

import argparse
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from support.schemas import fits
from support.training import train
from tilenca import cli
from tilenca.commands.train import add_arguments, report, share_named
from tilenca.model.file import load_model
from tilenca.training.recipes import RECIPES

WRITTEN = ("model.json", "weights.npz", "metrics.json", "history.csv", "README.md")


def test_the_same_seed_gives_the_same_bytes_and_json_names_them(
    two_shapes: Path, trained_model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = {name: (trained_model / name).read_bytes() for name in WRITTEN}
    assert train(two_shapes, trained_model, "--force", "--json") == 0
    assert {name: (trained_model / name).read_bytes() for name in WRITTEN} == before
    document = json.loads(capsys.readouterr().out)
    assert fits("train", document)
    assert document["model"] == str(trained_model)
    assert document["seconds"] > 0
    assert document["metrics"] == json.loads((trained_model / "metrics.json").read_text())


def test_ctrl_c_saves_a_checkpoint_says_how_to_go_on_and_exits_130(two_shapes: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ["train", "--shapes", two_shapes, "--out", out, "--recipe", "smoke", "--iterations", "1000"]
    process = subprocess.Popen(
        [sys.executable, "-u", "-m", "tilenca.cli", *map(str, words)], stderr=subprocess.PIPE, text=True
    )
    assert process.stderr is not None
    # The first measurement is told once the signal handler stands.
    first = ""
    while "seed 1:" not in first and process.poll() is None:
        first = process.stderr.readline()
    os.kill(process.pid, signal.SIGINT)
    _, rest = process.communicate(timeout=60)
    assert process.returncode == 130, first + rest
    assert "continue with: tilenca train" in rest
    assert "--resume" in rest
    assert (out / "checkpoint-1.pt").exists()
    assert not (out / "model.json").exists()


def test_a_model_says_how_it_was_made(trained_model: Path) -> None:
    metadata = load_model(trained_model).metadata
    assert (metadata["recipe_name"], metadata["seed"], metadata["recipe"]["iterations"]) == ("smoke", 5, 40)
    assert metadata["sources"][0]["file"] == "two.toml"
    assert load_model(trained_model).labels == ("1", "7", "-"), "tiles learn to say that they do not know"
    card = (trained_model / "README.md").read_text()
    assert metadata["command"] in card
    assert "the tiles' own clocks" in card


Refusal = Callable[[Path, Path], list[str]]
REFUSALS: list[tuple[str, Refusal]] = [
    ("holds a model already", lambda shapes, full: ["--shapes", str(shapes), "--out", str(full)]),
    (
        "no checkpoint of this run to resume",
        lambda shapes, full: ["--shapes", str(shapes), "--out", str(full), "--resume"],
    ),
    ("no recipe 'fast'", lambda shapes, full: ["--shapes", str(shapes), "--out", "x", "--recipe", "fast"]),
    ("room for 1;", lambda shapes, full: ["--shapes", str(shapes), "--out", "x", "--state", "2"]),
    ("--device tpu", lambda shapes, full: ["--shapes", str(shapes), "--out", "x", "--device", "tpu"]),
]


@pytest.mark.parametrize(("message", "words"), REFUSALS, ids=[message for message, _ in REFUSALS])
def test_what_cannot_be_done_is_refused_in_one_line(
    message: str,
    words: Refusal,
    two_shapes: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    full = tmp_path / "full"
    full.mkdir()
    (full / "model.json").write_text("{}")
    assert cli.main(["train", *words(two_shapes, full)]) == 2
    error = capsys.readouterr().err.strip()
    assert message in error
    assert len(error.splitlines()) == 1
    assert (full / "model.json").read_text() == "{}"


@pytest.mark.parametrize(
    "words",
    [
        ["--state", "1"],
        ["--hidden", "128"],
        ["--iterations", "0"],
        ["--learning-rate", "0"],
        ["--validation-runs", "x"],
        ["--seed", "-1"],
    ],
)
def test_values_that_make_no_sense_are_refused(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit, match="2"):
        cli.main(["train", "--out", str(tmp_path / "out"), *words])
    error = capsys.readouterr().err.strip()
    assert words[0] in error
    assert len(error.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def drawing(label: str, *rows: str) -> str:
    return f'[[shape]]\nlabel = "{label}"\ngrid = """\n' + "\n".join(rows) + '\n"""\n'


ODD_FILES = {
    "one class": drawing("1", "#", "#", "#"),
    "one tile and a ring": drawing("o", "#") + drawing("0", "#####", "#...#", "#...#", "#...#", "#####"),
    "only single tiles": drawing("1", "#"),
    "a drawing far from the other": drawing("L", "#....", "#....", "#....", "#....", "#####")
    + drawing("1", "##"),
    "a dash of its own": drawing("1", "#", "#", "#")
    + drawing("-", "##", "##")
    + drawing("7", "##", ".#", ".#"),
    "sizes": '[sizes]\nfrom = "3x2"\nto = "4x3"\nheld_out = ["4x2"]\n'
    + drawing("7", "##", ".#", ".#")
    + drawing("L", "#.", "#.", "##"),
}


@pytest.mark.parametrize("content", ODD_FILES.values(), ids=list(ODD_FILES))
def test_odd_shape_files_are_trained_and_examined(
    content: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "odd.toml"
    file.write_text(content)
    assert train(file, tmp_path / "out", "--iterations", "20") == 0
    words = ["evaluate", "--suite", "--model", str(tmp_path / "out"), "--shapes", str(file), "--runs", "2"]
    trained = json.loads((tmp_path / "out" / "metrics.json").read_text())
    capsys.readouterr()
    assert cli.main([*words, "--seed", str(trained["seed"]), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["metrics"]["rows"] == trained["rows"]


def test_as_many_classes_as_a_wide_state_has_room_for(tmp_path: Path) -> None:
    labels = "0123456789AbCcdEFGHhIJKLMnoPqrtUuVWXY_="
    rows = [format(number + 64, "b").replace("0", ".").replace("1", "#") for number in range(64)]
    file = tmp_path / "many.toml"
    drawings = (drawing(label, row, "#" * len(row)) for label, row in zip(labels, rows, strict=False))
    file.write_text("vary = false\n" + "".join(drawings))
    assert train(file, tmp_path / "out", "--iterations", "4", "--state", "51") == 0
    assert len(load_model(tmp_path / "out").labels) == len(labels) + 1


def test_sizes_at_which_two_classes_are_one_drawing_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "alike.toml"
    sizes = '[sizes]\nfrom = "3x3"\nto = "6x6"\n'
    file.write_text(
        sizes + drawing("1", "###", "#..", "#..") + drawing("7", "###", "#..", "#..", "#..", "#..")
    )
    assert train(file, tmp_path / "out") == 2
    assert "'1' and '7' are the same drawing at" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_full_disk_ends_training_with_one_line(
    two_shapes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    # A device on which there is never room, where the checkpoint is written before it is renamed.
    (out / "checkpoint-5.pt.part").symlink_to("/dev/full")
    assert train(two_shapes, out, "--iterations", "4") == 1
    said = capsys.readouterr()
    assert said.out == ""
    full = f"seed 5: {out}/checkpoint-5.pt: No space left on device; make room there, or give another --out"
    assert said.err.splitlines().count(full) == 1
    assert "Traceback" not in said.err
    assert [path.name for path in out.iterdir()] == ["sessions.json"]


def test_the_worst_missed_targets_come_first_and_the_card_has_the_rest(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [
        {"name": f"row {n}", "steps": 60, "share": n / 20, "target": 0.9, "floor": 0.0, "holds": n >= 18,
         "worst": {"shape": "4", "share": 0.0}}
        for n in range(20)
    ]  # fmt: skip
    words = ["--shapes", "mine.toml", "--out", str(tmp_path), "--recipe", "quick"]
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    report(parser.parse_args(words), tmp_path, {"rows": rows, "targets_held": "2 of 20"}, 60.0)
    said = capsys.readouterr().out.splitlines()
    assert [line.split(",")[0] for line in said[1:-1]] == [f"  missed: row {n}" for n in range(8)]
    assert said[-1] == f"  and 10 more, all in {tmp_path / 'README.md'}"


def test_how_well_a_model_names_its_drawings_is_the_least_of_the_rows_about_them() -> None:
    rows = [
        {"key": key, "share": share, "target": target}
        for key, share, target in (
            ("drawings", 0.3, None),  # after ten steps; nothing was aimed at
            ("drawings", 1.0, 0.9995),
            ("drawings", 0.85, 0.9995),
            ("unknown", 0.1, 0.98),
        )
    ]
    assert share_named({"rows": rows}) == 0.85
    assert share_named({"rows": []}) == 0.0


def test_a_model_that_names_too_few_of_its_drawings_ends_training_with_1_and_is_kept(
    two_shapes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(RECIPES, "brief", RECIPES["smoke"])  # smoke itself only tries the commands
    assert train(two_shapes, tmp_path, "--iterations", "2", "--recipe", "brief") == 1
    assert "of the runs only: do not rely on this model" in capsys.readouterr().err
    assert (tmp_path / "model.json").exists()


def test_a_training_that_begins_with_a_model_tells_so(two_shapes: Path, tmp_path: Path) -> None:
    assert train(two_shapes, tmp_path / "one") == 0
    words = ["--shapes", str(two_shapes), "--recipe", "smoke", "--seed", "6"]
    second = tmp_path / "two"
    assert cli.main(["train", *words, "--weights", str(tmp_path / "one"), "--out", str(second)]) == 0
    one, two = load_model(tmp_path / "one"), load_model(second)
    assert two.metadata["initial"] == f"{one.model_id:04X}"
    assert two.dimensions == one.dimensions
    assert f"--weights {tmp_path / 'one'}" in two.metadata["command"]
