"""`tilenca emulate` as a user types it, on the firmware that was built."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from support.avr import Compile
from support.firmware import board_test_image
from tilenca import cli
from tilenca.base import paths
from tilenca.base.paths import FIRMWARE_ELF
from tilenca.emulator.greeting import greeting
from tilenca.fleet.image import firmware_id, parse_hex
from tilenca.fleet.recording import read_recording
from tilenca.model.file import load_model
from tilenca.shapes.file import load_task, shape_table


@pytest.fixture(autouse=True)
def firmware() -> None:
    assert FIRMWARE_ELF.exists(), f"{FIRMWARE_ELF} is missing: run `pio run` before these tests"


def emulate(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    """Exit status, stdout, stderr."""
    try:
        status = cli.main(["emulate", *map(str, arguments)])
    except SystemExit as ended:
        status = int(ended.code or 0)
    said = capsys.readouterr()
    return status, said.out, said.err


def without_wall_time(document: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in document.items() if key != "wall_s"}


@pytest.fixture
def row(tmp_path: Path) -> Path:
    """Three tiles that are no digit at all, called "1"."""
    path = tmp_path / "row.toml"
    path.write_text('[[shape]]\nlabel = "1"\ngrid = """\n###\n"""\n')
    return path


def test_json_of_one_shape_is_one_object(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = emulate(capsys, "--shape", "1", "--json")
    report = json.loads(out)
    assert set(report) == {
        "shape", "model_id", "firmware_id", "simulated_s", "wall_s", "tiles", "all_right", "agreed_at_s",
        "agreed_after_first_update_s", "agreed_at_update", "verdict",
    }  # fmt: skip
    assert (status, report["verdict"]) == (0, "right")
    assert report["shape"] == "1"
    assert re.fullmatch("[0-9A-F]{4}", report["model_id"])
    image = parse_hex(FIRMWARE_ELF.with_suffix(".hex").read_text())
    assert report["firmware_id"] == f"{firmware_id(image):08X}"
    assert report["all_right"] is True
    assert [(tile["id"], tile["row"], tile["col"]) for tile in report["tiles"]] == [
        (i + 1, i, 0) for i in range(5)
    ]
    assert {tile["shown"] for tile in report["tiles"]} == {"1"}
    assert all(tile["rgb"] == [0, 20, 0] for tile in report["tiles"])  # green, as the authors chose
    assert all(tile["updates"] >= 30 for tile in report["tiles"])
    # The bootloader's second is a part of the time since there was power.
    assert 0.9 < report["agreed_at_s"] < report["simulated_s"]
    assert 0 < report["agreed_after_first_update_s"] < report["agreed_at_s"] - 0.9
    assert 0 < report["agreed_at_update"] <= 30
    middle = report["tiles"][2]["frames"]
    assert set(middle) == {"sent", "received", "corrupt", "lost"}
    assert middle["lost"] == 0
    assert middle["received"] >= 30


def test_a_seed_makes_a_run_reproducible(capsys: pytest.CaptureFixture[str]) -> None:
    def once(seed: int) -> dict[str, Any]:
        return without_wall_time(json.loads(emulate(capsys, "--shape", "1", "--json", "--seed", seed)[1]))

    assert once(5) == once(5)
    assert once(5) != once(6)


def test_several_shapes_come_in_the_order_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = emulate(capsys, "--shape", "7", "--shape", "1", "--json", "--updates", "20")
    document = json.loads(out)
    assert [run["shape"] for run in document["runs"]] == ["7", "1"]
    assert document["all_right"] is (status == 0)


def test_shapes_are_stretched_to_the_size_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = emulate(capsys, "--shape", "7", "--size", "3x3", "--json", "--updates", "3")
    assert status in (0, 1), "three updates may be too few"
    places = [(tile["row"], tile["col"]) for tile in json.loads(out)["tiles"]]
    assert places == [(0, 0), (0, 1), (0, 2), (1, 0), (1, 2), (2, 2)]
    status, _, err = emulate(capsys, "--shape", "8", "--size", "3x3")
    assert status == 2
    assert "no shape can be drawn that small" in err


def test_the_picture_shows_every_digit_and_a_verdict(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = emulate(capsys, "--shape", "1")
    assert status == 0
    top, side, bottom = "╭─────╮", "├─────┤", "╰─────╯"
    one = ["│   ╻ │", "│   ┃ │", "│   ╹ │"]
    assert out.splitlines()[:21] == [top, *one, *4 * [side, *one], bottom]
    assert "1: all 5 tiles show 1, since" in out
    assert "all 5 tiles" not in err, "the verdict is said once"
    assert "1 of 1 shapes right" in out
    assert "times real time" in err


def test_watching_without_a_terminal_tells_every_change(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = emulate(capsys, "--shape", "1", "--watch", "--updates", "12")
    assert status == 0
    assert all(f"1: tile {tile} shows 1" in out for tile in range(1, 6))
    assert "\x1b" not in out


def test_settings_reach_the_tiles(capsys: pytest.CaptureFixture[str]) -> None:
    at_once = ("--boot-spread", "0", "--bootloader", "none")
    _, out, _ = emulate(capsys, "--shape", "1", "--json", "--seconds", "3", "--period-ms", "200", *at_once)
    report = json.loads(out)
    assert report["simulated_s"] == 3.0
    assert all(13 <= tile["updates"] <= 15 for tile in report["tiles"])


def test_without_the_stock_bootloader_the_remedy_holds_from_a_wheel_too(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tilenca.commands.emulate.STOCK_BOOTLOADER", tmp_path / "stock.hex")
    _, _, err = emulate(capsys, "--shape", "1", "--seconds", "0.1")
    assert f"no {tmp_path / 'stock.hex'}, so tiles have no bootloader; install Arduino's AVR core" in err
    assert "--bootloader none" in err
    assert "make" not in err


def test_a_recording_can_be_replayed(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    record = tmp_path / "record.jsonl"
    assert emulate(capsys, "--shape", "1", "--updates", "10", "--record", record)[0] == 0
    lines = [json.loads(line) for line in record.read_text().splitlines()]
    assert {line["tile"] for line in lines} == {1, 2, 3, 4, 5}
    assert [line["time"] for line in lines] == sorted(line["time"] for line in lines)
    assert [line["place"] for line in lines[:5]] == [[row, 0] for row in range(5)]
    assert sum("$HELLO" in line["raw"] for line in lines[5:]) == 5
    assert len(list(read_recording(record))) == len(lines[5:])


def test_tiles_that_show_something_else_are_wrong_once_they_had_their_time(
    capsys: pytest.CaptureFixture[str], row: Path
) -> None:
    status, out, _ = emulate(capsys, "--shapes", row, "--updates", "60", "--seed", "1")
    assert status == 1
    assert "WRONG" in out
    status, out, _ = emulate(capsys, "--shape", "1", "--seconds", "0.001", "-v")  # nothing is shown yet
    assert status == 1
    assert "1: not yet, 5 of 5 tiles have done no update" in out
    assert "with --updates 60: tile 1 shows nothing, tile 2 shows nothing" in out


def test_an_unknown_shape_is_told_which_there_are(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = emulate(capsys, "--shape", "Q")
    assert (status, out) == (2, "")
    assert "no shape 'Q'; it has: 0 1 2 3 4 5 6 7 8 9" in err


def test_bad_images_that_were_given_are_usage_errors(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, avr: Compile
) -> None:
    other = avr("int main(void) { for (;;) { } }", mcu="atmega328p")
    for wrong, fact in {
        ("--elf", tmp_path / "none.elf"): "none.elf: No such file or directory; run `make demo` or `pio run`",
        ("--elf", tmp_path): f"{tmp_path}: not a file; run",
        ("--elf", other): "AVR architecture 5",
        ("--serve", tmp_path / "tiles", "--bootloader", tmp_path / "none"): "give --bootloader an ELF or",
    }.items():
        status, out, err = emulate(capsys, "--shape", "1", *wrong)
        assert (status, out) == (2, "")
        assert fact in err
        assert err.count("\n") == 1


def test_a_missing_build_of_our_own_ends_with_status_4(capsys: pytest.CaptureFixture[str]) -> None:
    status, _, err = emulate(capsys, "--shape", "1", "--elf", FIRMWARE_ELF.with_name("none.elf"))
    assert status == 4
    assert "pio run" in err


def test_shapes_the_firmware_was_not_trained_on_name_the_model_and_the_remedy(
    capsys: pytest.CaptureFixture[str], row: Path
) -> None:
    status, out, err = emulate(
        capsys, "--shapes", row, "--seconds", "1.5", "--boot-spread", "0", "--bootloader", "none"
    )
    assert status == 1
    assert re.search(
        "1: WRONG, . of 3 tiles show 1, .*; model [0-9A-F]{4} is models/digits; -v lists them", out
    )
    assert "is not for" not in err, "the model knows the label"
    assert err.count("takes these for something else; put these drawings, with their labels, into ") == 1
    assert f"model {load_model(paths.DEFAULT_MODEL).model_id:04X} was made of digits.toml" in err


def test_a_drawing_that_the_model_was_not_made_of_has_all_its_updates_and_is_told_as_one_run(
    capsys: pytest.CaptureFixture[str], row: Path
) -> None:
    quick = ("--bootloader", "none", "--boot-spread", "0", "--json")
    row.write_text(row.read_text() + shape_table("1", load_task(paths.DEFAULT_SHAPES).find("1").rows))
    _, out, err = emulate(capsys, "--shapes", row, *quick)
    altered, own = json.loads(out)["runs"]
    assert all(tile["updates"] >= 60 for tile in altered["tiles"])
    assert min(tile["updates"] for tile in own["tiles"]) < 60, "the model was made of this one"
    assert "note: the model was not made of 1: this is one run of one seed; more: tilenca simulate" in err
    assert err.count(f"--shapes {row} --shape 1 --runs 100") == 1


def test_a_file_with_classes_that_the_firmware_lacks_is_told_at_once(
    capsys: pytest.CaptureFixture[str],
) -> None:
    status, out, err = emulate(
        capsys, "--shapes", "letters", "--shape", "H", "--seconds", "0.05", "--bootloader", "none"
    )
    assert status == 1
    first, *_ = err.splitlines()
    ours = f"{load_model(paths.DEFAULT_MODEL).model_id:04X}"
    assert re.match(f"tilenca: the firmware's model {ours} is not for .*letters.toml", first)
    assert err.count("is not for") == 1
    assert "WRONG" in out


def test_large_drawings_get_the_updates_that_they_need(capsys: pytest.CaptureFixture[str]) -> None:
    quick = ("--bootloader", "none", "--boot-spread", "0", "--json")
    status, out, _ = emulate(capsys, "--shape", "1", "--size", "20x16", *quick)
    report = json.loads(out)
    assert (status, report["verdict"]) == (0, "right")
    assert all(tile["updates"] >= 30 for tile in report["tiles"])
    status, out, _ = emulate(capsys, "--shape", "4", "--size", "20x16", "--updates", "2", *quick)
    report = json.loads(out)
    assert (status, report["verdict"]) == (1, "not yet")
    assert all(tile["updates"] < 10 for tile in report["tiles"])


def test_the_shapes_are_those_of_the_firmwares_model(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    hexadecimal = tmp_path / "hex"
    shutil.copytree(paths.MODELS / "hex", hexadecimal)
    status, _, err = emulate(capsys, "--model", str(hexadecimal))
    assert (status, "no firmware was built of it" in err) == (4, True)
    hello = greeting(FIRMWARE_ELF)
    assert hello is not None
    says = replace(hello, model_id=0xE27F)
    monkeypatch.setattr("tilenca.commands.emulate.greeting", lambda elf: says)
    status, _, err = emulate(capsys, "--shape", "nothing")
    assert status == 2
    assert "hex.toml: no shape 'nothing'; it has: 0 1 2 3 4 5 6 7 8 9 A b C d E F" in err


@pytest.mark.parametrize(
    "ignored",
    [
        ("--serve", "x", "--record", "y"),
        ("--serve", "x", "--json"),
        ("--serve", "x", "--updates", "3"),
        ("--keep-running",),
        ("--watch", "--json"),
    ],
)
def test_options_that_would_be_ignored_are_refused(
    capsys: pytest.CaptureFixture[str], ignored: tuple[str, ...]
) -> None:
    status, out, err = emulate(capsys, "--shape", "1", *ignored)
    assert (status, out, err.count("\n")) == (2, "", 1)


def test_a_firmware_that_never_tells_is_given_up(capsys: pytest.CaptureFixture[str], avr: Compile) -> None:
    status, _, err = emulate(capsys, "--shape", "1", "--elf", avr("int main(void) { for (;;) { } }"))
    assert status == 1
    assert "0 updates" in err
    assert "--seconds" in err


@pytest.mark.parametrize(
    "wrong",
    [
        ("--seconds", "0"),
        ("--seconds", "x"),
        ("--seconds", "1e9"),
        ("--updates", "0"),
        ("--period-ms", "5"),
        ("--ppm", "-1"),
        ("--ppm", "100001"),
        ("--boot-spread", "3601"),
    ],
)
def test_numbers_out_of_range_are_usage_errors(
    capsys: pytest.CaptureFixture[str], wrong: tuple[str, str]
) -> None:
    assert emulate(capsys, "--shape", "1", *wrong)[0] == 2


def test_a_record_without_room_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    status, _, err = emulate(capsys, "--shape", "1", "--updates", "3", "--record", "/dev/full")
    assert status == 1
    assert err.splitlines()[-1].startswith("tilenca: /dev/full: No space left on device; ")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupt_ends_a_batch_with_130(number: signal.Signals) -> None:
    # Ten shapes: the first has been told of, most are still to come.
    command = [sys.executable, "-m", "tilenca.cli", "emulate", "--seconds", "3"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        assert running.stderr.readline().startswith("0: 3.0 s emulated")
        running.send_signal(number)
        out, err = running.communicate(timeout=60)
    assert (running.returncode, out) == (130, "")
    assert err.splitlines()[-1] == "tilenca: interrupted"
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("redirection", "status", "said"),
    [
        (">/dev/full", 1, "No space left on device"),
        (">&-", 1, "standard output is closed"),
        ("2>&-", 0, ""),
        ("| :", 1, ""),  # the pictures were not all shown
    ],
)
def test_streams_that_are_full_closed_or_left(redirection: str, status: int, said: str) -> None:
    script = f'"$@" --shape 1 --updates 3 {redirection}'
    words = ["bash", "-o", "pipefail", "-c", script, "bash", sys.executable, "-m", "tilenca.cli", "emulate"]
    environment = os.environ | {"PYTHONUNBUFFERED": "1"}
    done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False, env=environment)
    assert done.returncode == status, done.stderr
    assert said in done.stderr
    assert "Traceback" not in done.stderr
    assert "Exception ignored" not in done.stderr


def test_the_board_test_is_told_from_a_tile(capsys: pytest.CaptureFixture[str]) -> None:
    assert emulate(capsys, "--elf", board_test_image(), "--seconds", 1)[2].startswith(
        "tilenca: this image is the board test, which shows no label: give --serve DIR"
    )
