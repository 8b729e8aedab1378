"""Boards made faulty by `--fault`, as served ones are, and what the board test says of each."""

import re
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from support.firmware import board_test_image
from tilenca.base.errors import UsageError
from tilenca.emulator.board_faults import EXAMPLES, VALUES, parse
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.serve import STOCK_BOOTLOADER
from tilenca.shapes.file import Shape

BOOT_S, SLICE_S = 1.6, 0.01
ROW = Shape("1", ("##",), "row")


@contextmanager
def boards(*faults: str, ppm: float = 3000.0) -> Iterator[Emulation]:
    """Two boards side by side, as `tilenca emulate --serve` lays them out."""
    settings = EmulationSettings(
        boot_spread_s=0.2, ppm=ppm, seed=3, bootloader=STOCK_BOOTLOADER, faults=tuple(map(parse, faults))
    )
    emulation = Emulation(ROW, ["1"], board_test_image(), settings, None)
    with emulation.array:
        emulation.pass_time(BOOT_S)
        yield emulation


def said(emulation: Emulation, letter: str, seconds: float, tile: int = 0) -> list[str]:
    """What a board says to a letter."""
    array = emulation.array
    array[tile].read_serial()
    array[tile].write_serial(letter.encode())
    for _ in range(round(seconds / SLICE_S)):  # as a served one runs
        emulation.pass_time(SLICE_S)
    return array[tile].read_serial().decode().splitlines()


def test_faults_of_pins_and_lamps_are_named_together() -> None:
    with boards("joined=PH4+PH3@1", "led=3@1") as emulation:
        lines = said(emulation, "t", 3.0)
    assert "pins: FAIL, PH4 and PH3 are joined: look for a bridge of solder" in lines
    assert "link LEDs: FAIL, LED 3 is missing, or the wrong way round: PK2" in lines
    assert sum("FAIL" in line for line in lines if "self-test" not in line) == 2


def test_a_pin_that_is_stuck_is_named_and_the_end_of_all_faults_ends_them() -> None:
    with boards("high=PE3@1", "led=3@1:0-1.5", "joined=PH4+PH3@1:0-1.5") as emulation:
        lines = said(emulation, "t", 3.0)
    faults = [line for line in lines if "FAIL" in line and "self-test" not in line]
    assert faults == ["pins: FAIL, PE3 stays high: a short to the supply"]


def test_a_clock_is_off_for_the_board_beside_it() -> None:
    with boards("skew=25000@2", ppm=0.0) as emulation:
        [line] = [line for line in said(emulation, "t", 6.0) if line.startswith("clock")]
    assert "FAIL, the neighbour on E is 24 " in line
    assert "permille faster" in line


def test_a_plug_hands_back_what_a_clock_that_is_off_has_sent() -> None:
    with boards(*(f"plug@1{side}" for side in "NSW"), "low=PD2@1") as emulation:
        lines = said(emulation, "s", 1.6)
        for side in "NSW":
            assert f"side {side}: pass, loop-back" in lines
        assert any(line.startswith("side E: FAIL, always low") for line in lines)
        lines = said(emulation, "t", 3.5)
    assert "rate N: pass, loop-back at 125000 baud" in lines
    assert "rate W: pass, loop-back at 38400 baud" in lines


@pytest.mark.parametrize(
    ("text", "fact"),
    [
        ("short=PE3@1", "begins with none of loss"),
        ("high=E3@1", "high takes a pin, such as PE3, then @TILE"),
        ("high=PE3", "then @TILE"),
        ("joined=PE3@1", "joined takes two pins"),
        ("led=5@1", "led takes a link LED, 1 to 4"),
        ("plug@1", "plug takes no value, then @TILE and a side"),
        ("high=PE3@1:2-1", "it ends before it begins"),
    ],
)
def test_a_mistyped_fault_says_what_it_takes(text: str, fact: str) -> None:
    with pytest.raises(UsageError, match=fact) as refused:
        parse(text)
    assert re.search(r"^[^\n]*; for example [a-z]+[=@][^\n]*$", str(refused.value))


def test_every_kind_has_an_example_that_is_one() -> None:
    assert EXAMPLES.keys() == VALUES.keys()
    assert all(parse(text).kind == kind for kind, text in EXAMPLES.items())


@pytest.mark.parametrize(
    ("text", "fact"),
    [
        ("led=3@9", "no tile '9'"),
        ("plug@1E", "a plug goes on a side without a neighbour"),
        ("joined=PG6+PG7@2:5", "no pin PG6"),
        ("low=PI3@2:5", "PI3"),
    ],
)
def test_a_fault_of_a_place_that_is_not_there_is_refused(text: str, fact: str) -> None:
    with pytest.raises(UsageError, match=fact), boards(text):
        pass


def test_what_begins_in_a_long_slice_is_played_from_then_on() -> None:
    with boards("plug@1N:2.0") as emulation:
        emulation.array[0].read_serial()
        emulation.pass_time(0.3)
        emulation.array[0].write_serial(b"s")
        emulation.pass_time(0.1)
        emulation.array[0].write_serial(b"t")
        emulation.pass_time(3.0)
        lines = emulation.array[0].read_serial().decode().splitlines()
    assert "side N: pass, loop-back" in lines


def test_a_run_that_begins_when_a_fault_falls_due_is_as_long_as_any() -> None:
    with boards("skew=9000@1:1.7") as emulation:
        array = emulation.array
        emulation.pass_time(1.7 - array.time_s - 2e-6)  # it comes to that time by rounding
        assert array.time_s == pytest.approx(1.7, abs=1e-9)
        emulation.pass_time(0.05)
        assert array.time_s == pytest.approx(1.75, abs=16e-6)
