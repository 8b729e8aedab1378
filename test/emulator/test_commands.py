"""The host's commands on the chip: settings in EEPROM, the display, and nothing that stalls the tile."""

import itertools
import random

import pytest

from support.conversation import Talk
from tilenca.base.paths import FIRMWARE_ELF
from tilenca.base.sides import EAST, NORTH, SOUTH, WEST
from tilenca.emulator import Array
from tilenca.fleet.image import firmware_id, parse_hex
from tilenca.protocol.commands import ask_command, blink_command, restart_command, set_command
from tilenca.protocol.sentences import (
    AckSentence,
    ErrorSentence,
    HelloSentence,
    LinkSentence,
    NakSentence,
    TileSentence,
    TimeSentence,
    framed,
)
from tilenca.protocol.settings import parse_settings, settings_block
from tilenca.shapes.glyphs import GLYPHS, label_of_glyph

DARK, ALL = 0, GLYPHS["8"]


def test_the_firmware_id_is_that_of_the_hex_file(talk: Talk) -> None:
    memory = parse_hex(FIRMWARE_ELF.with_suffix(".hex").read_text())
    assert talk.last(HelloSentence).firmware_id == firmware_id(memory)


def test_a_tile_speaks_within_a_fifth_of_a_second(talk: Talk) -> None:
    with Array(FIRMWARE_ELF) as array:
        assert any(isinstance(s, HelloSentence) for s in Talk(array).listen(0.2))


def test_asked_it_greets_again(talk: Talk) -> None:
    hello = talk.last(HelloSentence)
    assert (hello.version, hello.tile, hello.period_ms, hello.updates, hello.brightness) == (
        3,
        7,
        100,
        0,
        255,
    )
    assert talk.ask(ask_command()) == hello


@pytest.mark.parametrize(
    ("name", "value", "kept"),
    [
        ("id", 200, (200, 100, 0, 255)),
        ("period", 250, (7, 250, 0, 255)),
        ("updates", 9, (7, 100, 9, 255)),
        ("brightness", 40, (7, 100, 0, 40)),
        ("preset", "paper", (7, 2000, 30, 255)),
    ],
)
def test_a_setting_is_kept_and_answered(talk: Talk, name: str, value: object, kept: tuple[int, ...]) -> None:
    assert isinstance(value, int | str)
    answer = talk.ask(set_command(name, value))
    assert answer == AckSentence(kept[0], "SET", (name, str(value)))
    settings = parse_settings(talk.tile.read_eeprom(0, 12))
    assert settings is not None
    assert (settings.tile_id, settings.period_ms, settings.updates, settings.brightness) == kept
    talk.tile.reset()
    talk.listen(0.3)
    hello = talk.last(HelloSentence)
    assert (hello.tile, hello.period_ms, hello.updates, hello.brightness) == kept


def test_a_period_is_in_force_at_once_and_the_state_goes_on(talk: Talk) -> None:
    before = talk.last(TileSentence).updates
    talk.ask(set_command("period", 50))
    talk.listen(1.0)
    after = talk.last(TileSentence).updates
    assert before + 18 <= after <= before + 23


def test_a_preset_can_be_taken_back(talk: Talk) -> None:
    built_in = talk.last(HelloSentence)
    with Array(FIRMWARE_ELF) as array:
        fresh = Talk(array)
        fresh.listen(0.3)
        built_in = fresh.last(HelloSentence)
    talk.ask(set_command("preset", "paper"))
    talk.ask(set_command("preset", "default"))
    hello = talk.ask(ask_command())
    assert isinstance(hello, HelloSentence)
    assert (hello.period_ms, hello.updates) == (built_in.period_ms, built_in.updates)


def test_writing_settings_stalls_neither_loop_nor_links() -> None:
    with Array(FIRMWARE_ELF, 2, [(0, EAST, 1, WEST), (0, NORTH, 1, SOUTH)], [900.0, -900]) as array:
        for tile in array:
            tile.write_eeprom(0, settings_block(tile.index + 1, 100, 0))
        talk, other = Talk(array), Talk(array, 1)
        talk.listen(3.2)
        usual_us = max(s.gap_us for s in talk.said if isinstance(s, TimeSentence))
        for value in (17, 255, 3, 96, 1, 64, 8, 128):  # each changes the value and the CRC: 10 ms of writing
            assert isinstance(talk.ask(set_command("id", value)), AckSentence)
        new = talk.listen(1.2)
        other.listen(0.0)
        slowest_us = max(s.gap_us for s in new if isinstance(s, TimeSentence))
        assert slowest_us < usual_us + 500, "writing a byte takes 3,400 us"
        for said in (talk.said, other.said):
            links = {s.side: s for s in said if isinstance(s, LinkSentence)}
            assert all(link.lost == link.overruns == 0 for link in links.values())
        assert talk.last(TimeSentence).dropped == 0


def test_several_commands_at_once_are_all_answered(talk: Talk) -> None:
    names = [("id", 9), ("period", 60), ("brightness", 1)]
    talk.tile.write_serial(b"".join(set_command(*pair) for pair in names))
    new = talk.listen(0.5)
    assert [s.fields for s in new if isinstance(s, AckSentence)] == [(n, str(v)) for n, v in names]


def test_what_is_no_command_is_refused_with_its_reason(talk: Talk) -> None:
    assert talk.ask(b"$ASK*00\r\n") == NakSentence(7, "CHECKSUM")
    assert talk.ask(b"$" + b"x" * 70) == NakSentence(7, "LONG")
    assert talk.ask(framed("FLY,3")) == NakSentence(7, "UNKNOWN", "FLY")
    assert talk.ask(framed("SET,period,5")) == NakSentence(7, "VALUE", "SET")
    assert talk.tile.read_eeprom(0, 12) == settings_block(7, 100, 0)


def test_random_bytes_at_full_rate_do_not_disturb_a_tile(talk: Talk) -> None:
    noise = random.Random(3)
    before = talk.last(TileSentence).updates
    talk.tile.write_serial(noise.randbytes(11520 * 3))
    talk.listen(3.0)
    assert talk.last(TileSentence).updates >= before + 29
    talk.listen(0.1)
    talk.said.clear()
    talk.tile.write_serial(b"\n")
    talk.listen(0.2)
    assert isinstance(talk.ask(ask_command()), HelloSentence)
    assert talk.damaged == []


def test_a_restart_begins_from_the_seed(talk: Talk) -> None:
    talk.listen(1.0)
    assert talk.ask(restart_command()) == AckSentence(7, "RESTART")
    talk.listen(0.2)
    assert talk.last(TileSentence).updates <= 3


def test_a_display_blinks_and_then_shows_its_class_again(talk: Talk) -> None:
    assert talk.ask(blink_command(2)) == AckSentence(7, "BLINK", ("2",))
    before = len(talk.tile.display_changes)
    talk.listen(2.2)
    seen = {change.segments for change in talk.tile.display_changes[before:]}
    assert {DARK, ALL} <= seen
    assert len(talk.tile.display_changes) - before > 6
    assert label_of_glyph(talk.tile.segments, tuple(GLYPHS)) == talk.last(TileSentence).label


SEGMENT_PINS = [("H", 4), ("H", 3), ("E", 3), ("B", 7), ("B", 6), ("H", 6), ("H", 5)]


def test_brightness_dims_the_link_leds_and_a_setting_turns_them_off() -> None:
    """They have no PWM: each is lit in every fourth millisecond, and never two at once."""
    links = [(0, EAST, 1, WEST), (0, SOUTH, 2, NORTH)]
    with Array(FIRMWARE_ELF, 3, links) as array:
        for tile in array:
            tile.write_eeprom(0, settings_block(tile.index + 1, 100, 0))
        array.run(1.0)
        talk = Talk(array)
        talk.listen(0.1)
        probes = [array[0].probe("K", bit) for bit in range(4)]
        for command, shares in (
            (set_command("brightness", 255), (0, 0.25, 0.25, 0)),
            (set_command("brightness", 64), (0, 0.25 * 64 / 255, 0.25 * 64 / 255, 0)),
            (set_command("leds", 0), (0, 0, 0, 0)),
            (set_command("leds", 1), (0, 0.25 * 64 / 255, 0.25 * 64 / 255, 0)),
            (set_command("brightness", 0), (0, 0, 0, 0)),
        ):
            assert isinstance(talk.ask(command), AckSentence)
            talk.listen(0.1)
            for probe in probes:
                probe.read()
            talk.listen(1.0)
            edges = [
                (edge.time_s, edge.level, led) for led, probe in enumerate(probes) for edge in probe.read()
            ]
            lit, since_s = set[int](), [0.0] * 4
            share = [0.0] * 4
            for time_s, level, led in sorted(edges):
                if level:
                    assert not lit, "two at once"
                    lit.add(led)
                    since_s[led] = time_s
                elif led in lit:
                    lit.remove(led)
                    share[led] += time_s - since_s[led]
            assert share == pytest.approx(shares, abs=0.002), command
            assert array[0].leds == tuple(part > 0 for part in shares)


def test_brightness_dims_every_segment_and_colour(talk: Talk) -> None:
    def duties() -> list[float]:
        """All segments, which are lit while the display blinks, and the colour then, which follows them."""
        talk.ask(blink_command(5))
        lit = 0
        for _ in range(200):
            talk.listen(0.005)
            lit = lit + 1 if talk.tile.segments == ALL else 0
            if lit == 3:
                return [talk.tile.duty(*pin) for pin in SEGMENT_PINS] + [v / 255 for v in talk.tile.rgb]
        raise AssertionError("a blinking display is lit half of the time")

    full = duties()
    assert full[:7] == [1.0] * 7
    for brightness in (1, 64, 254):
        talk.ask(set_command("brightness", brightness))
        dimmed = duties()
        for now, before in zip(dimmed, full, strict=True):
            # The duty is a whole number of 255, and so is that of the timer's counts: both round down.
            assert now == pytest.approx(before * brightness / 255, abs=2 / 255)
    talk.ask(set_command("brightness", 0))
    talk.listen(0.6)
    assert talk.tile.segments == DARK
    assert talk.tile.rgb == (0, 0, 0)
    talk.ask(set_command("brightness", 255))
    assert duties() == full


def test_dimming_does_not_harm_the_south_link() -> None:
    with Array(FIRMWARE_ELF, 2, [(0, SOUTH, 1, NORTH)], [3000.0, -3000]) as array:
        for tile in array:
            tile.write_eeprom(0, settings_block(tile.index + 1, 50, 0, brightness=90))
        talk, other = Talk(array), Talk(array, 1)
        talk.listen(1.0)
        for value in range(10, 250, 20):
            talk.ask(set_command("brightness", value))
        talk.listen(1.0)
        other.listen(0.0)
        for said, side in ((talk.said, "S"), (other.said, "N")):
            link = [s for s in said if isinstance(s, LinkSentence) and s.side == side][-1]
            assert (link.lost, link.corrupt, link.overruns) == (0, 0, 0)
            assert link.received > 30


@pytest.mark.parametrize(
    ("contents", "told"),
    [
        (b"\xff" * 12, False),
        (settings_block(7, 100, 0), False),
        (b"\0" * 12, True),
        (settings_block(7, 100, 0)[:-1] + b"\0", True),
        (b"TN\1" + bytes(9), True),
    ],
)
def test_damaged_settings_are_told_and_blank_ones_are_not(contents: bytes, told: bool) -> None:
    with Array(FIRMWARE_ELF) as array:
        array[0].write_eeprom(0, contents)
        said = Talk(array).listen(0.5)
    errors = [s for s in said if isinstance(s, ErrorSentence)]
    assert [error.code for error in errors] == (["SETTINGS"] if told else [])
    hello = next(s for s in said if isinstance(s, HelloSentence))
    assert hello.tile == (7 if contents == settings_block(7, 100, 0) else 0)


def boots_with(eeprom: bytes) -> tuple[int, ...]:
    """The settings of a tile that starts with this EEPROM; it must not complain."""
    with Array(FIRMWARE_ELF) as array:
        array[0].write_eeprom(0, eeprom)
        said = Talk(array).listen(0.2)
    assert not any(isinstance(s, ErrorSentence) for s in said)
    hello = next(s for s in said if isinstance(s, HelloSentence))
    return hello.tile, hello.period_ms, hello.updates, hello.brightness


@pytest.mark.parametrize("before", [settings_block(7, 100, 0), settings_block(7, 100, 0) * 2])
def test_when_the_power_fails_while_settings_are_written_the_old_or_the_new_ones_hold(before: bytes) -> None:
    """Cut off in every byte: it is as it was, erased, half written, or whole."""
    old, new = (7, 100, 0, 255), (7, 257, 0, 255)  # both bytes of the period, and of the CRC
    with Array(FIRMWARE_ELF) as array:
        array[0].write_eeprom(0, before)
        talk = Talk(array)
        talk.listen(0.3)
        images = [array[0].read_eeprom(0, 24)]
        array[0].write_serial(set_command("period", 257))
        for _ in range(100):
            array.run(0.001)
            if (image := array[0].read_eeprom(0, 24)) != images[-1]:
                images.append(image)
    assert images[-1] == settings_block(7, 257, 0) * 2
    found = []
    for earlier, later in itertools.pairwise(images):
        (at,) = [n for n in range(24) if earlier[n] != later[n]]
        for torn in (earlier[at], 0xFF, later[at] | 0x0F, later[at]):
            found.append(boots_with(earlier[:at] + bytes([torn]) + earlier[at + 1 :]))
    assert found == sorted(found), "once new, always new"
    assert set(found) == {old, new}


def test_power_may_fail_in_two_changes_one_after_the_other() -> None:
    """The first tears the first block; the second, in the second block, must find that mended."""
    old, new = settings_block(7, 100, 0), settings_block(7, 257, 0)
    torn = new[:4] + b"\xff" + old[5:]
    with Array(FIRMWARE_ELF) as array:
        array[0].write_eeprom(0, torn + new)
        talk = Talk(array)
        talk.listen(0.4)
        assert array[0].read_eeprom(0, 24) == new * 2
        array[0].write_serial(set_command("period", 1000))
        for _ in range(200):
            array.run(0.0005)
            if array[0].read_eeprom(0, 24) != new * 2:
                break
        second_cut = array[0].read_eeprom(0, 24)
    assert parse_settings(second_cut[12:]) is None, "cut off in the middle"
    assert boots_with(second_cut) == (7, 257, 0, 255)


@pytest.mark.parametrize("stuck", [8, 12 + 8])
def test_a_worn_byte_in_either_block_is_told_and_the_old_settings_hold(talk: Talk, stuck: int) -> None:
    """The byte keeps the old brightness, whatever is written."""
    old = settings_block(7, 100, 0)
    talk.tile.write_eeprom(0, old * 2)
    talk.tile.write_serial(set_command("brightness", 40))
    answers = []
    for _ in range(400):
        answers += [s for s in talk.listen(0.0005) if isinstance(s, AckSentence | NakSentence)]
        if talk.tile.read_eeprom(stuck, 1) != old[8:9]:
            talk.tile.write_eeprom(stuck, old[8:9])
    assert answers == [NakSentence(7, "EEPROM", "SET")]
    assert talk.tile.read_eeprom(0, 24) == old * 2
    hello = talk.ask(ask_command())
    assert isinstance(hello, HelloSentence)
    assert hello.brightness == 255
    assert boots_with(talk.tile.read_eeprom(0, 24)) == (7, 100, 0, 255)


def test_a_reset_while_a_byte_is_written_does_not_hide_the_settings(talk: Talk) -> None:
    """The start-up code alone takes about as long as a byte; a shorter one must not read too early."""
    talk.tile.write_serial(set_command("id", 9))
    done = settings_block(9, 100, 0)
    for _ in range(2000):
        talk.array.run(0.00005)
        if talk.tile.read_eeprom(0, 12) == done:  # the last byte is on its way
            break
    talk.tile.reset()
    talk.said.clear()
    talk.listen(0.3)
    assert talk.last(HelloSentence).tile == 9
    assert not any(isinstance(s, ErrorSentence) for s in talk.said)
