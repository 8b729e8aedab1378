"""The board test on emulated tiles: what it shows, and that it names the line that is broken."""

import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from support.alone import alone
from tilenca.base.paths import ROOT
from tilenca.base.sides import EAST, NORTH, SOUTH, WEST
from tilenca.emulator import Array, EmulatedTile, LinkFault
from tilenca.emulator.board_faults import Plug
from tilenca.protocol.board_test import board_test_text
from tilenca.protocol.line_reader import LineReader

SIDES = (NORTH, EAST, SOUTH, WEST)
STEP_S = 0.002
START_S = 0.05
PASS = "pass, a tile that hears this one, from its side "


@pytest.fixture(scope="module")
def elf(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The image of the environment `board_test`, built as users build it."""
    pio = str(Path(sys.executable).with_name("pio"))
    with alone("pio"):
        subprocess.run([pio, "run", "-s", "-d", str(ROOT), "-e", "board_test"], check=True)
    return ROOT / ".pio" / "build" / "board_test" / "firmware.elf"


def run(array: Array, seconds: float, plugs: Iterable[Plug] = ()) -> None:
    """Runs on, with what leaves a plug's side coming in again."""
    plugs = list(plugs)
    end_s = array.time_s + seconds
    while array.time_s < end_s:
        array.run(STEP_S if plugs else seconds)
        for plug in plugs:
            plug.play()


def started(elf: Path, *arguments: Any, **options: Any) -> Array:
    """Tiles that have begun to listen."""
    array = Array(elf, *arguments, **options)
    array.run(START_S)
    return array


def lines(tile: EmulatedTile) -> list[str]:
    return tile.read_serial().decode().splitlines()


def sides(tile: EmulatedTile) -> dict[str, str]:
    """What was last said of each side."""
    said = [line.removeprefix("side ").partition(": ") for line in lines(tile) if line.startswith("side ")]
    return {side: result for side, _, result in said}


def test_every_segment_led_and_colour_is_lit_alone_and_named(elf: Path) -> None:
    array = started(elf)
    tile = array[0]
    shown = []
    for _ in range(8):
        run(array, 0.25)
        shown.append(tile.segments)
        run(array, 0.25)
    assert shown == [1 << n for n in range(8)]
    said = lines(tile)
    assert "display: only segment a PH4" in said
    assert "display: only segment dp PG5" in said
    tile.write_serial(b"l")
    lit = []
    for _ in range(4):
        run(array, 0.25)
        lit.append(tile.leds)
        run(array, 0.25)
    assert lit == [tuple(n == led for n in range(4)) for led in range(4)]
    tile.write_serial(b"c")
    colours = []
    for _ in range(3):
        run(array, 0.25)
        colours.append([duty > 0 for duty in tile.rgb])
        run(array, 0.25)
    assert colours == [[n == colour for n in range(3)] for colour in range(3)]
    assert {"LEDs: only LED 1 PK0", "colours: only red PB5"} <= set(lines(tile))


def test_the_button_passes_by_being_pressed_and_goes_to_the_next_step(elf: Path) -> None:
    array = started(elf)
    tile = array[0]
    for shown in (0x38, 0x39, 0x3F, 1):
        run(array, 0.1)
        tile.press_button()
        run(array, 0.1)
        assert "button: pass, pressed" in lines(tile)
        tile.press_button(False)
        assert tile.segments == shown
    tile.write_serial(b"b?")
    run(array, 0.1)
    assert any(line == "button: open" for line in lines(tile))


def test_the_host_knows_every_line_for_the_board_test_s(elf: Path) -> None:
    array = Array(elf, 2, [(0, EAST, 1, WEST)])
    tile = array[0]
    tile.press_button()
    tile.hold_pin(*tile.side_pin(SOUTH, receiving=True), False)
    for letter in "dlcsb?":
        tile.write_serial(letter.encode())
        run(array, 2.0)
    found = LineReader().feed(tile.read_serial())
    said = [board_test_text(raw) for raw, sentence in found if sentence is None]
    assert len(said) == len(found) > 20
    assert None not in said, [raw for raw, _ in found]
    beginnings = {line.partition(":")[0] for line in said if line}
    sides = {f"side {side}" for side in "NESW"}
    assert beginnings == {"board test", "button", "display", "LEDs", "colours"} | sides


def test_a_button_that_is_stuck_is_named_at_the_start(elf: Path) -> None:
    array = Array(elf)
    array[0].press_button()
    run(array, 0.1)
    assert any(line.startswith("button: FAIL") and line.endswith("PF0") for line in lines(array[0]))


def test_loop_back_plugs_make_all_sides_pass(elf: Path) -> None:
    array = started(elf)
    tile = array[0]
    plugs = [Plug(array, tile, side) for side in SIDES]
    tile.write_serial(b"s")
    run(array, 2.2, plugs)
    assert sides(tile) == dict.fromkeys("NESW", "pass, loop-back")
    assert tile.leds == (True,) * 4
    assert tile.segments == 0x66  # 4
    assert [duty > 0 for duty in tile.rgb] == [False, True, False]


@pytest.mark.parametrize("broken", SIDES)
def test_of_four_loop_back_plugs_the_broken_one_is_named(elf: Path, broken: int) -> None:
    array = started(elf)
    tile = array[0]
    plugs = {side: Plug(array, tile, side) for side in SIDES}
    tile.write_serial(b"s")
    run(array, 1.2, list(plugs.values()))
    run(array, 1.2, [plug for side, plug in plugs.items() if side != broken])
    pin = "P{}{}".format(*tile.side_pin(broken, receiving=True))
    expected = dict.fromkeys("NESW", "pass, loop-back")
    expected["NESW"[broken]] = f"FAIL, heard nothing: no plug, no tile, or a broken line to {pin}"
    assert sides(tile) == expected
    assert tile.leds == tuple(side != broken for side in SIDES)
    assert tile.segments == 0x4F  # 3
    assert tile.rgb[0] > 0


def test_a_line_that_is_always_low_is_named(elf: Path) -> None:
    array = started(elf)
    tile = array[0]
    for side in (NORTH, SOUTH):
        tile.hold_pin(*tile.side_pin(side, receiving=True), False)
    tile.write_serial(b"s")
    run(array, 1.2)
    said = sides(tile)
    assert said["N"] == "FAIL, always low: a short, or a broken line to PH0"
    assert said["S"] == "FAIL, always low: a short, or a broken line to PK6"


@pytest.mark.parametrize(("side", "other"), [(EAST, WEST), (SOUTH, NORTH)])
def test_two_tiles_test_each_other(elf: Path, side: int, other: int) -> None:
    array = started(elf, 2, [(0, side, 1, other)], ppm=[3000, -3000], switch_on_s=[0, 0.0123])
    array[0].write_serial(b"s")
    array[1].write_serial(b"s")
    run(array, 3.0)
    assert sides(array[0])["NESW"[side]] == PASS + "NESW"[other]
    assert sides(array[1])["NESW"[other]] == PASS + "NESW"[side]
    # One line breaks: who still hears says that it is not heard, and on which pin it sends.
    array.set_fault(0, side, LinkFault(loss=1.0))
    run(array, 1.5)
    pin = "P{}{}".format(*array[0].side_pin(side))
    expected = f"FAIL, a tile that does not hear this one: a broken line from {pin}"
    assert sides(array[0])["NESW"[side]] == expected
    assert sides(array[1])["NESW"[other]].startswith("FAIL, heard nothing")
    array.set_fault(0, side, LinkFault())
    run(array, 1.5)
    assert sides(array[0])["NESW"[side]] == PASS + "NESW"[other]


def test_a_line_that_loses_bytes_now_and_then_is_unreliable(elf: Path) -> None:
    array = started(elf, 2, [(0, EAST, 1, WEST)])
    array.set_fault(0, EAST, LinkFault(loss=0.02), seed=1)
    array[1].write_serial(b"s")
    run(array, 3.0)
    assert sides(array[1])["W"].startswith("FAIL, packets lost: ")


def test_sides_that_do_not_mate_hear_nothing(elf: Path) -> None:
    array = started(elf, 2, [(0, EAST, 1, NORTH)])
    for tile in array:
        tile.write_serial(b"s")
    run(array, 1.5)
    assert sides(array[0])["E"].startswith("FAIL, heard nothing")
    assert sides(array[1])["N"].startswith("FAIL, heard nothing")
