"""Watching emulated tiles: the keys, and what is said of them."""

import os
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from support.terminal import read_until
from tilenca.base import paths
from tilenca.commands.emulate_watch import KEYS, SPEEDS, USUAL, Hands
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.shapes.file import load_task

LIMIT_S = 600


@pytest.fixture
def hands(firmware: Path) -> Iterator[Hands]:
    """The "1" of three tiles."""
    task = load_task(paths.SHAPES / "digits-3x3.toml")
    emulation = Emulation(task.find("1"), task.labels, firmware, EmulationSettings(boot_spread_s=0.0), None)
    with emulation.array:
        yield Hands(emulation, period_s=0.02)


def test_space_stops_time_and_a_point_lets_one_step_pass(hands: Hands) -> None:
    assert hands.slice_s() > 0
    hands.obey(" ")
    assert hands.slice_s() == 0
    hands.obey(".")
    while run_s := hands.slice_s():
        hands.emulation.advance(run_s)
    assert hands.emulation.array.time_s == pytest.approx(0.02, abs=1e-4)
    assert hands.caption()[1].endswith("paused")
    hands.obey(" ")
    assert hands.slice_s() > 0


def test_speeds_end_at_both_ends_and_are_told(hands: Hands) -> None:
    for _ in SPEEDS:
        hands.obey("+")
    assert SPEEDS[hands.speed] == 4
    assert "4 times real time" in hands.caption()[1]
    for _ in SPEEDS:
        hands.obey("-")
    assert SPEEDS[hands.speed] == 1 / 16
    assert "1/16 of real time" in hands.caption()[1]
    assert hands.slice_s() < 0.01, "slow time is smooth"
    hands.speed = USUAL
    assert "real time" not in hands.caption()[1]


def test_a_pulled_tile_is_out_until_it_is_put_back_and_one_stays(hands: Hands) -> None:
    hands.emulation.advance(0.5)
    for _ in range(3):
        hands.obey("p")
    standing = [tile.index for tile in hands.emulation.array if tile.powered]
    assert len(standing) == 1
    assert hands.caption()[0].startswith("1: 1 of 1 tiles show 1") or "of 1 tiles" in hands.caption()[0]
    assert "pulled: tiles " in hands.caption()[1]
    hands.obey("b")
    assert all(tile.powered for tile in hands.emulation.array)
    hands.emulation.advance(1.0)
    assert hands.emulation.all_right, "they agree again, over mended cables"


def test_a_tile_of_a_number_is_pulled_and_the_keys_answer(hands: Hands) -> None:
    for key in "3p":
        hands.obey(key)
    assert hands.out == [2]
    for key, said in (
        ("9", "tile 9: p pulls it"),
        ("p", "no tile 9 with power to pull"),
        ("x", "no key x; "),
    ):
        hands.obey(key)
        assert said in hands.caption()[1]
    hands.updates = 550
    hands.obey("b")
    assert "update 550" in hands.caption()[1], "a tile that is put back does not count the others back"
    hands.obey("q")
    assert "pulled and put back: 3" in hands.caption()[1]


def test_other_keys_do_nothing_but_say_so(hands: Hands) -> None:
    before = vars(hands) | {"said": "no key ?; the keys are below"}
    for key in ("x", "up", "\n", "?"):
        hands.obey(key)
    assert vars(hands) == before


@pytest.mark.parametrize(("key", "shapes"), [("q", 1), ("n", 2)])
def test_on_a_terminal_a_shape_runs_until_a_key_ends_it(key: str, shapes: int, firmware: Path) -> None:
    words = ["emulate", "--elf", str(firmware), "--shape", "1", "--shape", "7", "--watch"]
    words += ["--shapes", str(paths.SHAPES / "digits-3x3.toml"), "--bootloader", "none"]
    master, slave = os.openpty()
    environment = os.environ | {"TERM": "xterm-256color", "COLUMNS": "80", "LINES": "24"}
    with subprocess.Popen(
        [sys.executable, "-m", "tilenca.cli", *words], stdin=slave, stdout=slave, stderr=slave,
        env=environment, start_new_session=True,
    ) as process:  # fmt: skip
        os.close(slave)
        read_until(master, "1: 3 of 3 tiles show 1")
        os.write(master, b"p")
        read_until(master, "pulled: tile")
        os.write(master, b"b" + key.encode())
        if shapes == 2:
            read_until(master, "7: ")
            read_until(master, KEYS)
            os.write(master, b"q")
        read_until(master, f" of {shapes} shapes right")
        assert process.wait(LIMIT_S) in (0, 1), "where a key ended it, tiles may be on their way"
    os.close(master)


def test_with_standard_input_closed_it_shows_the_tiles_without_keys(firmware: Path) -> None:
    words = ["emulate", "--elf", str(firmware), "--shape", "1", "--watch", "--bootloader", "none"]
    words += ["--shapes", str(paths.SHAPES / "digits-3x3.toml")]
    master, slave = os.openpty()
    command = shlex.join([sys.executable, "-m", "tilenca.cli", *words])
    with subprocess.Popen(
        ["sh", "-c", f"exec {command} <&-"], stdin=subprocess.DEVNULL, stdout=slave, stderr=slave,
        env=os.environ | {"TERM": "xterm-256color", "COLUMNS": "80", "LINES": "24"},
    ) as process:  # fmt: skip
        os.close(slave)
        read_until(master, "1 of 1 shapes right")
        assert process.wait(LIMIT_S) == 0
    os.close(master)
