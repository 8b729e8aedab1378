"""`tilenca emulate` with faults, threads, kept EEPROMs, waveforms and debuggers, on the real firmware."""

from pathlib import Path
from typing import Any

import pytest

from support.emulate import emulate, report
from tilenca.base.paths import FIRMWARE_ELF
from tilenca.base.sides import EAST, WEST
from tilenca.emulator.array import Array
from tilenca.emulator.fault_spec import parse
from tilenca.emulator.faults import Faults
from tilenca.emulator.states import SENDING


@pytest.fixture(autouse=True)
def firmware() -> None:
    assert FIRMWARE_ELF.exists(), f"{FIRMWARE_ELF} is missing: run `pio run` before these tests"


def received(document: dict[str, Any]) -> list[int]:
    return [tile["frames"]["received"] for tile in document["tiles"]]


AT_ONCE = ("--boot-spread", "0", "--bootloader", "none")
SECONDS = ("--seconds", "3", "--period-ms", "100", *AT_ONCE)


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
    assert "1: all 4 tiles with power show 1" in out
    off = report(capsys, *SECONDS, "--fault", "remove@5:1")["tiles"][4]
    assert (off["shown"], off["updates"]) == ("", 8)


def test_a_tile_that_is_switched_on_again_counts_from_there(capsys: pytest.CaptureFixture[str]) -> None:
    document = report(capsys, "--updates", "20", "--period-ms", "100", *AT_ONCE, "--fault", "off@3:1-1.5")
    assert document["all_right"]
    assert document["tiles"][2]["updates"] in (20, 21)
    assert document["simulated_s"] == pytest.approx(3.65, abs=0.1)
    assert 0 < document["agreed_at_update"] <= 20
    again = report(capsys, "--updates", "20", "--period-ms", "100", *AT_ONCE, "--fault", "reset@3:1.5")
    assert again["simulated_s"] == pytest.approx(3.65, abs=0.1)


def test_a_turned_tile_hears_nobody_until_it_lies_straight_again(capsys: pytest.CaptureFixture[str]) -> None:
    before = received(report(capsys, *SECONDS))
    after = received(report(capsys, *SECONDS, "--fault", "turn@3:1-2", "--fault", "cut@3-4:0.5-1.5"))
    assert before[0] == after[0]
    assert before[1] - after[1] in range(8, 13)  # of its two neighbours, one
    assert before[2] - after[2] in range(22, 29)  # of both, and a while before of one
    assert before[3] - after[3] in range(13, 18)


def test_a_clock_that_is_far_off_understands_nobody(capsys: pytest.CaptureFixture[str]) -> None:
    well = report(capsys, *SECONDS, "--fault", "skew=5000@3")
    assert sum(tile["frames"]["corrupt"] for tile in well["tiles"]) == 0
    off = report(capsys, *SECONDS, "--fault", "skew=-90000@3")
    assert received(off)[1] in range(received(well)[1] // 2 - 3, received(well)[1] // 2 + 4)
    assert received(off)[0] == received(well)[0]


@pytest.mark.parametrize("fault", ["loss=0.02", "delay=3", "drift=50", "skew=2000", "adc=2"])
def test_the_same_seed_gives_the_same_bytes_on_any_number_of_threads(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, fault: str
) -> None:
    documents, records = [], []
    for threads, seed in ((1, 3), (2, 3), (2, 4)):
        record = tmp_path / f"{threads}-{seed}.jsonl"
        options = ("--threads", threads, "--seed", seed, "--fault", fault, "--record", record)
        documents.append(report(capsys, "--seconds", "1.5", "--bootloader", "none", *options))
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
        ("cut@1-3", "no cable there; tile 1 has S to tile 2"),
        ("cut@9", "no tile '9'; they are 1 to 5, from left to right and top to bottom"),
        ("off@0:1", "no tile '0'"),
        ("loss=1@1N", "no cable there"),
        ("cut@1-2:3-2", "it ends before it begins"),
        ("reset@1:1-2", "reset has no end"),
        ("cut@1-2:soon", "'soon' is no time in seconds"),
        ("losses=1", "it begins with none of loss, flip, delay"),
        ("resat@1", "it begins with none of loss, flip, delay"),
        *((spec, f"after {spec.partition(mark)[0]} comes [=VALUE]") for mark, spec in BROKEN_OFF),
    ],
)
def test_a_fault_that_cannot_be_is_one_line(capsys: pytest.CaptureFixture[str], spec: str, fact: str) -> None:
    status, out, err = emulate(capsys, "--fault", spec)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert f"--fault '{spec}': {fact}" in err
    assert "; for example " in err
    if fact.startswith("no "):
        assert "tilenca: shape '1': --fault" in err, "another shape may have that tile or cable"


def test_a_fault_waits_for_its_time_where_a_tile_is_halted_before() -> None:
    with Array(FIRMWARE_ELF, 2, [(0, EAST, 1, WEST)]) as array:
        faults = Faults(array, [(0, EAST, 1, WEST)], 1)
        faults.add(parse("off@2:0.3"))
        array[0].set_breakpoint(SENDING)
        faults.run(0.4)
        assert array.halted
        assert array.time_s < 0.3
        assert array[1].powered
        array[0].set_breakpoint(SENDING, on=False)
        array[0].resume()
        faults.run(0.4)
        assert not array[1].powered


def test_a_fault_that_was_to_begin_after_the_end_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    status, _, err = emulate(capsys, *SECONDS, "--fault", "off@5:1", "--fault", "loss=1:60-61")
    assert status == 0
    assert err.count("had not begun") == 1
    assert "--fault 'loss=1:60-61' had not begun when shape '1' ended after" in err
    assert "with --seconds 62" in err
