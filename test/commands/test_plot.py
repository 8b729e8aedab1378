"""Pictures of a training and of tiles at work: what is drawn, the same every time, and what is refused."""

import json
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from support.films import film_of
from support.schemas import fits
from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.cli import main
from tilenca.commands.plot import read_history
from tilenca.model.file import load_model
from tilenca.shapes.glyphs import look_of, screen_colour
from tilenca.views import plots
from tilenca.views.reel import LAST_S


def plot(*arguments: object) -> int:
    try:
        return main(["plot", *map(str, arguments)])
    except SystemExit as ended:
        return int(ended.code or 0)


def test_a_strip_is_a_png_of_some_width(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "film.png"
    assert plot("--shape", 4, "--film", path, "--steps", 9, "--json") == 0
    report = json.loads(capsys.readouterr().out)
    film = film_of("4", steps=9)
    assert report == {
        "file": str(path),
        "model": f"{load_model(paths.DEFAULT_MODEL).model_id:04X}",
        "shape": "4",
        "then": None,
        "schedule": "clock",
        "seed": 1,
        "steps": 9,
        "pictures": 10,
        "agreed_at": film.agreed_at,
    }
    with Image.open(path) as image:
        assert image.format == "PNG"
        assert image.width == plots.WIDTH_IN * plots.DPI
        image.load()


def test_a_gif_has_one_frame_per_step_and_shows_the_runs_colours(tmp_path: Path) -> None:
    path = tmp_path / "film.gif"
    assert plot("--shape", 4, "--film", path, "--steps", 12, "--schedule", "clock") == 0
    wanted = np.array(screen_colour(look_of("4", 4).colour)) * 255
    with Image.open(path) as image:
        assert (image.format, getattr(image, "n_frames", 0)) == ("GIF", 13)
        shares = []
        for frame in range(13):
            image.seek(frame)
            pixels = np.asarray(image.convert("RGB")).astype(float)
            shares.append(float((np.abs(pixels - wanted).max(axis=2) < 12).mean()))
        assert image.info["duration"] == LAST_S * 1000
    assert shares[0] == 0
    assert shares[-1] == max(shares) > 0.1


def test_films_of_the_same_seed_are_the_same_bytes(tmp_path: Path) -> None:
    for suffix in (".png", ".svg", ".gif"):
        first, second = tmp_path / f"first{suffix}", tmp_path / f"second{suffix}"
        for path in (first, second):
            assert (
                plot("--shape", "1", "--film", path, "--steps", 3, "--schedule", "random", "--seed", 5) == 0
            )
        assert first.read_bytes() == second.read_bytes()


def test_a_second_drawing_can_be_filmed(tmp_path: Path) -> None:
    shapes = paths.SHAPES / "digits-3x3.toml"
    assert plot("--shapes", shapes, "--shape", "7@2", "--film", tmp_path / "f.svg", "--steps", 2) == 0
    assert ET.parse(tmp_path / "f.svg").getroot().tag.endswith("svg")


def test_the_history_of_the_shipped_model(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for kind in ("png", "svg"):
        assert plot("--out", tmp_path / "deep" / "er", "--format", kind) == 0
        assert capsys.readouterr().out == f"{tmp_path}/deep/er/history.{kind}\n"
    with Image.open(tmp_path / "deep" / "er" / "history.png") as image:
        assert image.width == plots.WIDTH_IN * plots.DPI
    assert ET.parse(tmp_path / "deep" / "er" / "history.svg").getroot().tag.endswith("svg")


def test_a_history_is_drawn_beside_its_model(tmp_path: Path) -> None:
    shutil.copytree(paths.DEFAULT_MODEL, tmp_path / "model")
    assert plot("--model", tmp_path / "model") == 0
    assert (tmp_path / "model" / "history.png").exists()


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("iteration,loss,agreement\n50,1,0\n100,x,0\n", ":3: "),
        ("iteration,loss,agreement\n50,1\n", ":2: 2 fields for 3 columns"),
        ("\xff", "not a training history"),
    ],
)
def test_a_damaged_history_names_its_line(text: str, where: str, tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(UsageError, match=where):
        read_history(path)


def test_empty_fields_of_a_history_are_not_measured(tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    path.write_text("iteration,loss,agreement,@60\n50,1,0,\n100,0.5,1,0.25\n", encoding="utf-8")
    columns, rows = read_history(path)
    assert columns[3] == "@60"
    assert rows == [[50, 1, 0, None], [100, 0.5, 1, 0.25]]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--shape", "4"], "--shape is of a film; add --film"),
        (["--steps", "5"], "--steps is of a film"),
        (["--film", "f.png"], "of which shape? add --shape NAME"),
        (["--then", "5"], "--then is of a film; add --film"),
        (
            ["--film", "f.png", "--shape", "4", "--every", "2"],
            "--every says how a shape is rebuilt; add --then",
        ),
        (["--film", "f.png", "--shape", "4", "--then", "A"], "no shape 'A'; it has: 0 1"),
        (
            ["--film", "f.png", "--shape", "4", "--then", "1", "--schedule", "random"],
            "leave --schedule random",
        ),
        (
            ["--film", "f.png", "--shape", "4", "--replay", "r"],
            "--shape is of a simulated run; --replay shows",
        ),
        (
            ["--film", "f.png", "--replay", "r"],
            "r: No such file or directory; give a file that --record wrote",
        ),
        (["--film", "f.jpg", "--shape", "4"], "f.jpg: a film is written as .png, .svg, .gif"),
        (["--film", "f.gif", "--shape", "4", "--out", "d"], "--out is for the picture of the training"),
        (["--film", "f.png", "--shape", "A"], "no shape 'A'; it has: 0 1"),
        (["--film", "f.png", "--shape", "A", "--shapes", paths.SHAPES / "hex.toml"], "does not know 'A'"),
        (["--film", "no/such/f.png", "--shape", "4"], "f.png: No such file or directory"),
        (["--film", "no/such/f.gif", "--shape", "4"], "f.gif: No such file or directory"),
        (["--film", "f.png", "--shape", "4", "--steps", "0"], "'0' is not a whole number from 1 to 500"),
        (["--model", "nowhere"], "model.json: No such file"),
        (["--out", "/proc/none"], "/proc/none: "),
        (["--format", "pdf"], "invalid choice: 'pdf'"),
    ],
)
def test_what_cannot_be_drawn_is_one_line(
    arguments: list[object],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert plot(*arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert words in said.err
    assert list(tmp_path.iterdir()) == []


def test_a_model_without_history_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copytree(paths.DEFAULT_MODEL, tmp_path / "model")
    (tmp_path / "model" / "history.csv").unlink()
    assert plot("--model", tmp_path / "model") == 2
    assert "history.csv: No such file or directory; give --model" in capsys.readouterr().err


def test_without_matplotlib_the_remedy_is_named(tmp_path: Path) -> None:
    program = "import sys; sys.modules['matplotlib'] = None; from tilenca.cli import main; sys.exit(main())"
    for arguments in (["--out", tmp_path], ["--shape", "4", "--film", tmp_path / "f.gif"]):
        done = subprocess.run(
            [sys.executable, "-c", program, "plot", *map(str, arguments)],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert done.returncode == 2
        assert (
            done.stderr == "tilenca: plots need matplotlib, which is not installed; run: make setup-train\n"
        )


def test_a_folder_is_not_called_like_a_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plot", "--out", str(tmp_path / "history.png")]) == 2
    assert "give a folder" in capsys.readouterr().err
    assert not (tmp_path / "history.png").exists()


def test_a_model_needs_no_option_and_brings_its_own_shapes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    letters = paths.MODELS / "letters"
    assert plot(letters, "--film", tmp_path / "f.svg", "--shape", "L", "--steps", 2) == 0
    assert (tmp_path / "f.svg").exists()
    assert plot(letters, "--model", paths.MODELS / "hex") == 2
    assert "which one? give one model" in capsys.readouterr().err


def test_a_shape_can_be_rebuilt_into_another(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "f.gif"
    assert plot("--film", path, "--shape", 4, "--then", 1, "--steps", 12, "--every", 2, "--json") == 0
    report = json.loads(capsys.readouterr().out)
    assert fits("plot-film", report)
    assert report["then"] == "1"
    assert report["steps"] > 24
    with Image.open(path) as image:
        assert getattr(image, "n_frames", 0) == report["pictures"] == report["steps"] + 1


def test_the_targets_that_a_model_holds_are_in_its_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert plot("digits-drawn", "--out", tmp_path, "--format", "svg") == 0
    with_targets = (tmp_path / "history.svg").read_bytes()
    shutil.copytree(paths.MODELS / "digits-drawn", tmp_path / "model")
    (tmp_path / "model" / "metrics.json").write_text("{}", encoding="utf-8")
    assert plot(tmp_path / "model", "--out", tmp_path, "--format", "svg") == 0
    without = (tmp_path / "history.svg").read_bytes()
    assert without != with_targets
    assert capsys.readouterr().err == ""
    (tmp_path / "model" / "metrics.json").write_text('{"rows": 3}', encoding="utf-8")
    assert plot(tmp_path / "model", "--out", tmp_path, "--format", "svg") == 0
    assert (tmp_path / "history.svg").read_bytes() == without
    assert capsys.readouterr().err.startswith(f"note: {tmp_path}/model/metrics.json: not the metrics")


def test_a_recording_of_tiles_can_be_filmed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recording = tmp_path / "r.jsonl"
    assert main(["emulate", "--shape", "1", "--seconds", "2", "--record", str(recording)]) in (0, 1)
    capsys.readouterr()
    assert plot("--film", tmp_path / "r.gif", "--replay", recording, "--json") == 0
    report = json.loads(capsys.readouterr().out)
    assert fits("plot-recording", report)
    assert report["tiles"] == 5
    with Image.open(tmp_path / "r.gif") as image:
        assert getattr(image, "n_frames", 0) == report["pictures"] > 1
