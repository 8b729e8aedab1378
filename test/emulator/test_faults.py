"""`tilenca emulate` with faults, threads, kept EEPROMs, waveforms and debuggers, on the real firmware."""

import json
import re
import signal
import socket
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from tilenca import cli
from tilenca.base.paths import FIRMWARE_ELF


@pytest.fixture(autouse=True)
def firmware() -> None:
    assert FIRMWARE_ELF.exists(), f"{FIRMWARE_ELF} is missing: run `pio run` before these tests"


def emulate(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    """Exit status, stdout, stderr."""
    try:
        status = cli.main(["emulate", "--shape", "1", *map(str, arguments)])
    except SystemExit as ended:
        status = int(ended.code or 0)
    said = capsys.readouterr()
    return status, said.out, said.err


def report(capsys: pytest.CaptureFixture[str], *arguments: object) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(emulate(capsys, "--json", *arguments)[1])
    del document["wall_s"]
    return document


def received(document: dict[str, Any]) -> list[int]:
    return [tile["frames"]["received"] for tile in document["tiles"]]


SECONDS = ("--seconds", "3", "--boot-spread", "0", "--period-ms", "100")


def test_a_loss_of_all_bytes_in_one_direction_leaves_the_other(capsys: pytest.CaptureFixture[str]) -> None:
    whole, spoilt = report(capsys, *SECONDS), report(capsys, *SECONDS, "--fault", "loss=1@2S")
    before, after = received(whole), received(spoilt)
    # Tile 3 hears nothing from tile 2, and all of tile 4.
    assert after[2] in range(before[2] // 2 - 3, before[2] // 2 + 4)
    assert after[:2] == before[:2]
    assert after[3:] == before[3:]


def test_flipped_bits_make_corrupt_frames(capsys: pytest.CaptureFixture[str]) -> None:
    spoilt = report(capsys, *SECONDS, "--fault", "flip=0.002")
    assert sum(tile["frames"]["corrupt"] for tile in spoilt["tiles"]) > 20
    assert all(tile["updates"] >= 25 for tile in spoilt["tiles"])


def test_a_cable_cut_for_a_while_costs_the_frames_of_that_while(capsys: pytest.CaptureFixture[str]) -> None:
    before = received(report(capsys, *SECONDS))
    after = received(report(capsys, *SECONDS, "--fault", "cut@1-2:1-2"))
    assert before[0] - after[0] in range(8, 13)
    assert after[2:] == before[2:]


def test_a_tile_without_power_is_not_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = emulate(capsys, *SECONDS, "--fault", "off@5:1")
    assert status == 0
    assert "1: all 4 tiles show 1" in out
    off = report(capsys, *SECONDS, "--fault", "remove@5:1")["tiles"][4]
    assert (off["shown"], off["updates"]) == ("", 8)


def test_a_tile_that_is_switched_on_again_counts_from_there(capsys: pytest.CaptureFixture[str]) -> None:
    document = report(
        capsys, "--updates", "20", "--period-ms", "100", "--boot-spread", "0", "--fault", "off@3:1-1.5"
    )
    assert document["all_right"]
    assert document["tiles"][2]["updates"] in (20, 21)
    assert document["simulated_s"] == pytest.approx(3.65, abs=0.1)
    assert 0 < document["agreed_at_update"] <= 20
    again = report(
        capsys, "--updates", "20", "--period-ms", "100", "--boot-spread", "0", "--fault", "reset@3:1.5"
    )
    assert again["simulated_s"] == pytest.approx(3.65, abs=0.1)


@pytest.mark.parametrize("fault", ["loss=0.02", "delay=3", "drift=50", "adc=2"])
def test_the_same_seed_gives_the_same_bytes_on_any_number_of_threads(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, fault: str
) -> None:
    documents, records = [], []
    for threads, seed in ((1, 3), (2, 3), (2, 4)):
        record = tmp_path / f"{threads}-{seed}.jsonl"
        options = ("--threads", threads, "--seed", seed, "--fault", fault, "--record", record)
        documents.append(report(capsys, "--seconds", "1.5", *options))
        records.append(record.read_text())
    assert documents[0] == documents[1]
    assert records[0] == records[1]
    assert records[1] != records[2]


BROKEN_OFF = (("=", "loss="), ("@", "reset@1:-1"), ("@", "off@1:0-"), ("@", "cut@"))


@pytest.mark.parametrize(
    ("spec", "fact"),
    [
        ("bang", "it begins with none of loss, flip, delay"),
        ("loss", "loss takes a number"),
        ("cut=1@1-2", "cut takes no number"),
        ("loss=x", "'x' is no number"),
        ("loss=-1", "'-1' is no number"),
        ("loss=nan", "'nan' is no number"),
        ("flip=1.5", "flip is 0 to 1"),
        ("cut", "cut needs a place"),
        ("cut@1-3", "no cable there"),
        ("cut@9", "no tile '9'; they are 1 to 5"),
        ("off@0:1", "no tile '0'"),
        ("loss=1@1N", "no cable there"),
        ("cut@1-2:3-2", "it ends before it begins"),
        ("reset@1:1-2", "reset has no end"),
        ("cut@1-2:soon", "'soon' is no time in seconds"),
        ("losses=1", "it begins with none of loss, flip, delay"),
        *((spec, f"after {spec.partition(mark)[0]} comes [=VALUE]") for mark, spec in BROKEN_OFF),
    ],
)
def test_a_fault_that_cannot_be_is_one_line(capsys: pytest.CaptureFixture[str], spec: str, fact: str) -> None:
    status, out, err = emulate(capsys, "--fault", spec)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert f"--fault '{spec}': {fact}" in err


def test_an_eeprom_outlives_the_run(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    directory = tmp_path / "eeprom"
    report(capsys, "--seconds", "0.2", "--period-ms", "250", "--eeprom", directory)
    files = sorted(path.name for path in directory.iterdir())
    assert files == [f"tile-0{n}.eeprom" for n in range(1, 6)]
    assert all((directory / name).stat().st_size == 4096 for name in files)
    # The period of the first run is still there.
    slow = report(capsys, "--seconds", "3", "--boot-spread", "0", "--eeprom", directory)
    assert all(tile["updates"] in (11, 12) for tile in slow["tiles"])
    (directory / "tile-03.eeprom").write_bytes(b"short")
    status, _, err = emulate(capsys, "--eeprom", directory)
    assert (status, err.count("\n")) == (2, 1)
    assert "tile-03.eeprom: 5 bytes, an EEPROM has 4096; delete it" in err


def test_waveforms_of_chosen_pins_are_written(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "waves.vcd"
    report(capsys, "--seconds", "0.5", "--boot-spread", "0", "--vcd", path, "--pin", "2:K7", "--pin", "3:PH1")
    text = path.read_text()
    assert "$scope module tile2 $end\n$var wire 1 ! PK7 $end" in text
    assert '$scope module tile3 $end\n$var wire 1 " PH1 $end' in text
    assert len(re.findall(r"^[01]!$", text, re.MULTILINE)) > 50
    report(capsys, "--seconds", "0.05", "--vcd", path)
    assert path.read_text().count("$var") == 5 * 4


def test_frames_on_every_cable_are_written_both_ways(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "frames.jsonl"
    document = report(capsys, *SECONDS, "--frames", path)
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    assert set(lines[0]) == {"time", "tile", "side", "frame"}
    assert [line["time"] for line in lines] == sorted(line["time"] for line in lines)
    for tile in document["tiles"]:
        neighbours = 1 if tile["id"] in (1, 5) else 2
        sent = [line for line in lines if line["tile"] == tile["id"]]
        assert {line["side"] for line in sent} == {
            side for side, there in (("N", tile["id"] > 1), ("S", tile["id"] < 5)) if there
        }
        # Of four sides each frame is counted once; one may be on its way.
        assert len(sent) in range(tile["frames"]["sent"] // 4 * neighbours - 2, tile["frames"]["sent"])
    assert len({line["frame"] for line in lines}) > 50


@pytest.mark.parametrize(
    ("options", "fact"),
    [
        (("--vcd", "x", "--pin", "3:I1"), "--pin 3:I1: not a tile and a pin; for example 3:H1"),
        (("--vcd", "x", "--pin", "9:H1"), "--pin 9:H1: no tile 9; shape '1' has 1 to 5"),
        (("--pin", "1:H1"), "--pin does nothing without --vcd"),
        (("--gdb", "6"), "--gdb 6: no tile 6"),
        (("--gdb", "x"), "--gdb x: not a tile and a port"),
        (("--vcd", "/nowhere/x.vcd", "--seconds", "0.01"), "/nowhere/x.vcd: No such file or directory; give"),
        (("--vcd", "x", "--shape", "4"), "--vcd needs one shape, got 2"),
        (("--frames", "/nowhere/x", "--seconds", "0.01"), "/nowhere/x: No such file or directory; give"),
        (("--threads", "0"), "'0' is not a whole number from 1"),
    ],
)
def test_what_cannot_be_looked_at_is_one_line(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    options: tuple[str, ...], fact: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    status, out, err = emulate(capsys, *options)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert fact in err


def test_a_debugger_is_waited_for_and_then_obeyed() -> None:
    command = [sys.executable, "-m", "tilenca.cli", "emulate", "--shape", "1", "--seconds", "0.5", "--json"]
    with subprocess.Popen(
        [*command, "--gdb", "4"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as running:
        assert running.stderr is not None
        line = running.stderr.readline()
        port = re.search(r"tile 4 waits for: avr-gdb -ex 'target remote :(\d+)'", line)
        assert port, line
        with socket.create_connection(("127.0.0.1", int(port[1])), 60) as debugger:
            debugger.sendall(b"$?#3f")
            answer = b""
            while not answer.endswith(b"#b8"):
                answer += debugger.recv(100)
            assert answer == b"+$S05#b8"
            debugger.sendall(b"$c#63")
            out, _ = running.communicate(timeout=60)
    assert running.returncode in (0, 1)
    assert json.loads(out)["simulated_s"] == 0.5


@pytest.mark.parametrize("with_debugger", [False, True])
@pytest.mark.parametrize("look", [(), ("--watch",)])
def test_an_interrupt_ends_the_wait_for_a_debugger(with_debugger: bool, look: tuple[str, ...]) -> None:
    command = [sys.executable, "-m", "tilenca.cli", "emulate", "--shape", "1", "--gdb", "4", *look]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        port = re.search(r":(\d+)'", running.stderr.readline())
        assert port
        with ExitStack() as stack:
            if with_debugger:
                debugger = stack.enter_context(socket.create_connection(("127.0.0.1", int(port[1])), 60))
                debugger.sendall(b"$?#3f")
                assert debugger.recv(1) == b"+"
            running.send_signal(signal.SIGINT)
            _, err = running.communicate(timeout=60)
    assert running.returncode == 130
    assert err.splitlines()[-1] == "tilenca: interrupted"
    assert "Traceback" not in err
