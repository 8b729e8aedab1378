"""A tile that hangs starts again and says so; it knows why it started, and who is a stranger."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from support.avr import hex_record
from support.conversation import Talk
from tilenca.base.paths import FIRMWARE_ELF
from tilenca.base.sides import EAST, WEST
from tilenca.emulator import Array, ResetCause
from tilenca.emulator.serve import STOCK_BOOTLOADER
from tilenca.protocol.constants import LINK_BAUD
from tilenca.protocol.frames import Frame, encode_frame
from tilenca.protocol.sentences import ErrorSentence, HelloSentence, LinkSentence, TileSentence, TimeSentence
from tilenca.protocol.settings import settings_block

CLOCK = 16_000_000
BOOTLOADER_AT, RAM_END = 0x3E000, 0x2200
HANGS, HANGS_DEAF = "__stop_program", "_exit"  # a jump to itself, and the `cli` before it
POWER_ON, EXTERNAL, BROWN_OUT, WATCHDOG = 1, 2, 4, 8


def hang(talk: Talk, place: str) -> int:
    """Lets a tile loop for ever; returns where."""
    address = talk.array.code_address(place)
    talk.tile.halt()
    talk.tile.pc = address
    talk.tile.resume()
    talk.said.clear()
    return address


def needs(bootloader: Path) -> Path:
    if not bootloader.exists():
        pytest.skip("arduino-core-avr is not installed; run `make setup`")
    return bootloader


@pytest.mark.parametrize("boot", [False, True])
def test_a_tile_that_hangs_starts_again_and_says_where(boot: bool) -> None:
    bootloader = needs(STOCK_BOOTLOADER) if boot else None
    with Array(FIRMWARE_ELF, 2, [(0, EAST, 1, WEST)], bootloader=bootloader) as array:
        for tile in array:
            tile.write_eeprom(0, settings_block(tile.index + 1, 100, 0))
        talk = Talk(array)
        talk.listen(2.0)
        for _ in range(2):  # it can do so again and again
            address = hang(talk, HANGS)
            talk.listen(0.7)
            assert talk.last(HelloSentence).reset_cause == WATCHDOG
            error = talk.last(ErrorSentence)
            assert (error.code, error.text) == ("WATCHDOG", f"hung at 0x{address:05X}")
        talk.said.clear()
        talk.listen(1.0)
        assert talk.last(TileSentence).updates >= 9
        assert talk.last(TileSentence).links == "-E--"
        assert array[0].leds == (False, True, False, False)
        talk.tile.reset()
        talk.said.clear()
        talk.listen(1.5)
        assert talk.last(HelloSentence).reset_cause == EXTERNAL
        assert not any(isinstance(s, ErrorSentence) for s in talk.said)


def test_a_tile_that_hangs_with_interrupts_off_is_reset(talk: Talk) -> None:
    hang(talk, HANGS_DEAF)
    talk.listen(1.0)
    assert talk.last(HelloSentence).reset_cause == WATCHDOG
    assert (talk.last(ErrorSentence).code, talk.last(ErrorSentence).text) == ("WATCHDOG", "hung")
    assert talk.last(TileSentence).updates >= 1
    said = len(talk.said)
    talk.listen(2.0)
    assert not any(isinstance(s, HelloSentence) for s in talk.said[said:]), "once is enough"


def long_way_round(path: Path) -> Path:
    """The stock boot loader behind erased flash as the chip runs it: 0xFFFF skips nothing while r31 is 0.

    The emulator stops there instead, so that a program that goes astray is noticed.
    """
    no_operation, half = bytes(16), 0x10000
    records = []
    for page, end in ((2, half), (3, BOOTLOADER_AT % half)):
        records.append(hex_record(4, 0, bytes([0, page])))
        records += [hex_record(0, at, no_operation) for at in range(0, end, len(no_operation))]
    path.write_text("".join(records) + needs(STOCK_BOOTLOADER).read_text())
    return path


def test_behind_the_stock_boot_loader_it_comes_back_by_the_long_way(tmp_path: Path) -> None:
    """A true watchdog reset: the boot loader jumps into erased flash, which ends where it begins itself."""
    with Array(FIRMWARE_ELF, bootloader=long_way_round(tmp_path / "boot.hex")) as array:
        talk = Talk(array)
        talk.listen(1.5)
        hang(talk, HANGS_DEAF)
        talk.listen(2.5)
        hellos = [s for s in talk.said if isinstance(s, HelloSentence)]
        assert [hello.reset_cause for hello in hellos] == [EXTERNAL], "MCUSR is gone: it looks like a reset"
        assert talk.last(TileSentence).updates > 20


def test_the_cause_of_a_start_is_told(talk: Talk) -> None:
    assert talk.last(HelloSentence).reset_cause == POWER_ON
    for cause, told in ((ResetCause.EXTERNAL, EXTERNAL), (ResetCause.BROWN_OUT, BROWN_OUT)):
        talk.tile.reset(cause)
        talk.listen(0.3)
        assert talk.last(HelloSentence).reset_cause == told


def test_behind_the_stock_boot_loader_a_reset_is_told_from_a_power_on() -> None:
    with Array(FIRMWARE_ELF, bootloader=needs(STOCK_BOOTLOADER)) as array:
        talk = Talk(array)
        talk.listen(1.5)
        assert talk.last(HelloSentence).reset_cause == POWER_ON
        talk.tile.reset()
        talk.listen(1.5)
        assert talk.last(HelloSentence).reset_cause == EXTERNAL
        talk.tile.powered = False
        array.run(0.1)
        talk.tile.powered = True
        talk.listen(1.5)
        assert talk.last(HelloSentence).reset_cause == POWER_ON


def test_the_unused_stack_is_what_the_emulator_says(talk: Talk) -> None:
    talk.listen(15.0)  # a byte a millisecond is looked at, and fewer while it computes
    stack = talk.tile.stack
    assert talk.last(TimeSentence).stack_unused == pytest.approx(stack.deepest - stack.floor, abs=2)


def test_the_first_report_of_a_slow_tile_knows_its_stack() -> None:
    with Array(FIRMWARE_ELF) as array:
        array[0].write_eeprom(0, settings_block(7, 10_000, 0))
        talk = Talk(array)
        talk.listen(1.3)
        stack = array[0].stack
    unused = talk.last(TimeSentence).stack_unused
    assert stack.deepest - stack.floor <= unused < RAM_END - stack.floor


def test_a_stack_that_was_almost_full_is_told_once(talk: Talk) -> None:
    talk.tile.write_memory(talk.tile.stack.floor + 50, b"\0")
    talk.listen(4.0)
    assert [s.code for s in talk.said if isinstance(s, ErrorSentence)] == ["STACK"]
    assert talk.last(TimeSentence).stack_unused == 50


def test_the_share_of_time_awake_is_what_the_emulator_says(talk: Talk) -> None:
    talk.listen(0.5)
    before, asleep_before = talk.tile.cycles
    talk.listen(4.0)
    after, asleep = talk.tile.cycles
    times = [s for s in talk.said if isinstance(s, TimeSentence)][-3:]
    told = sum(s.awake_permille for s in times) / len(times) / 1000
    assert told == pytest.approx(1 - (asleep - asleep_before) / (after - before), abs=0.03)
    for time in times:
        assert time.compute_us < 1000 * told * 100
        assert 1000 <= time.gap_us < 6000
        assert time.dropped == 0


def bits_of(data: bytes) -> Iterator[bool]:
    for byte in data:
        yield from (False, *(bool(byte >> bit & 1) for bit in range(8)), True)


def send_north(talk: Talk, data: bytes) -> None:
    """What a neighbour in the north would send, as edges on the pin."""
    port, bit = talk.tile.side_pin(0, receiving=True)
    start = talk.tile.cycles[0] + 2000
    level = True
    for number, now in enumerate(bits_of(data)):
        if now != level:
            talk.tile.push_edge(port, bit, start + round(number * CLOCK / LINK_BAUD), now)
            level = now


def test_a_neighbour_of_another_model_is_absent_and_its_led_blinks(talk: Talk) -> None:
    model = talk.last(HelloSentence).model_id
    channels = talk.last(HelloSentence).channels
    seen, links = set(), set()
    for sequence in range(20):
        send_north(talk, encode_frame(Frame(2, 9, sequence, model ^ 1, (0,) * channels)))
        for _ in range(5):
            talk.listen(0.02)
            seen.add(talk.tile.leds[0])
        links.add(talk.last(TileSentence).links)
    assert seen == {True, False}
    assert links == {"----"}
    north = [s for s in talk.said if isinstance(s, LinkSentence) and s.side == "N"][-1]
    assert (north.received, north.neighbour) == (0, None)
    assert north.foreign > 5
    send_north(talk, encode_frame(Frame(2, 9, 0, model, (0,) * channels)))
    talk.listen(0.2)
    assert talk.tile.leds[0]
    assert talk.last(TileSentence).links == "N---"
    talk.listen(0.5)
    assert not talk.tile.leds[0], "silent again"


def test_a_tile_that_speaks_version_1_is_no_neighbour(talk: Talk) -> None:
    hello = talk.last(HelloSentence)
    frame = bytearray(encode_frame(Frame(2, 9, 0, hello.model_id, (0,) * hello.channels)))
    frame[1] = frame[1] & 0x0F | 0x10
    send_north(talk, bytes(frame))
    talk.listen(0.5)
    north = [s for s in talk.said if isinstance(s, LinkSentence) and s.side == "N"][-1]
    assert (north.received, north.corrupt) == (0, 1)
