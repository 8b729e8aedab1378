"""What `tilenca emulate` lets one look at: waveforms, frames, debuggers."""

import json
import re
import signal
import socket
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import pytest

from support.emulate import emulate, report

AT_ONCE = ("--boot-spread", "0", "--bootloader", "none")
SECONDS = ("--seconds", "3", "--period-ms", "100", *AT_ONCE)


def test_waveforms_of_chosen_pins_are_written(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "waves.vcd"
    report(capsys, "--seconds", "0.5", *AT_ONCE, "--vcd", path, "--pin", "2:K7", "--pin", "3:PH1")
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
