"""tilenca set: what it prints and refuses; what tiles do with it is in test_fleet.py."""

import json
import re
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace

import pytest

from support.schemas import fits
from support.scripted_port import HELLO, Device
from support.tile_port import STATE
from tilenca import cli
from tilenca.protocol.commands import ask_command, set_command
from tilenca.protocol.sentences import AckSentence, NakSentence, TileSentence, format_sentence

Answer = Callable[[bytes, int], bytes]


def tile(number: int, keeps: bool = True) -> Device:
    """A tile with a brightness of 255 that takes another one, or says so and does not keep it."""
    kept = [255]

    def answer(line: bytes, count: int) -> bytes:
        if line == ask_command():
            return format_sentence(replace(HELLO, tile=number, brightness=kept[0]))
        value = re.fullmatch(rb"\$SET,brightness,(\d+)\*..\r\n", line)
        if value is None:
            return format_sentence(NakSentence(number, "VALUE", "SET"))
        kept[0] = int(value[1]) if keeps else kept[0]
        return format_sentence(AckSentence(number, "SET", ("brightness", value[1].decode())))

    return Device(format_sentence(TileSentence(number, 100, 1, "4", 4, 30, "----", STATE)), answer)


def set_in(devices: list[Device], *words: str) -> int:
    with ExitStack() as stack:
        for device in devices:
            stack.enter_context(device)
        ports = [word for device in devices for word in ("--port", device.port)]
        return cli.main(["set", *words, *ports])


def test_what_is_acknowledged_is_read_back_and_told(capsys: pytest.CaptureFixture[str]) -> None:
    devices = [tile(1), tile(2)]
    assert set_in(devices, "brightness", "80", "--json") == 0
    document = json.loads(capsys.readouterr().out)
    assert fits("set", document)
    assert [(row["tile"], row["result"], row["settings"]["brightness"]) for row in document["tiles"]] == [
        (1, "set", 80),
        (2, "set", 80),
    ]
    assert all(set_command("brightness", 80) in device.heard for device in devices)


def test_what_is_acknowledged_and_not_kept_is_a_failure(capsys: pytest.CaptureFixture[str]) -> None:
    assert set_in([tile(1), tile(2, keeps=False)], "brightness", "80") == 1
    header, first, second = capsys.readouterr().out.splitlines()
    assert header.split() == ["PORT", "TILE", "RESULT", "ID", "PERIOD", "UPDATES", "BRIGHTNESS", "WHY"]
    assert first.split()[1:] == ["1", "set", "1", "20", "0", "80"]
    assert second.split()[1:4] == ["2", "failed", "2"]
    assert second.endswith("acknowledged, but brightness is 255")


def test_only_the_tile_that_is_meant_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    devices = [tile(1), tile(2)]
    assert set_in(devices, "brightness", "80", "--tile", "2", "--json") == 0
    assert [row["tile"] for row in json.loads(capsys.readouterr().out)["tiles"]] == [2]
    assert not any(line.startswith(b"$SET") for line in devices[0].heard)


def test_a_tile_that_is_not_there_is_no_device(capsys: pytest.CaptureFixture[str]) -> None:
    assert set_in([tile(1)], "brightness", "80", "--tile", "9") == 3
    assert "no tile 9 answers" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (("brightness", "256"), "brightness '256': must be a whole number in 0..255"),
        (("brightness", "bright"), "brightness 'bright': must be a whole number"),
        (("period", "1.5"), "period '1.5'"),
        (("colour", "3"), "no setting 'colour'"),
        (("preset", "fast"), "no preset 'fast'"),
        (("board", "2"), "it is REVISION.SERIAL, such as 2.17"),
        (("board", "0.17"), "the revision is 1..255"),
        (("board", "2.65536"), "the serial number 0..65535"),
        (("brightness", "9", "--replace"), "--replace does nothing without board"),
    ],
)
def test_what_no_tile_takes_is_refused_before_a_port_is_opened(
    words: tuple[str, str], complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["set", *words, "--port", "/dev/no-such-port"]) == 2
    said = capsys.readouterr()
    assert complaint in said.err
    assert said.err.count("\n") == 1


def test_one_id_is_not_given_to_two_tiles(capsys: pytest.CaptureFixture[str]) -> None:
    devices = [tile(1), tile(2)]
    assert set_in(devices, "id", "7") == 2
    assert "2 tiles would have the same id" in capsys.readouterr().err
    assert not any(line.startswith(b"$SET") for device in devices for line in device.heard)


def marked(number: int, marking: tuple[str, str]) -> Device:
    """A tile that has a marking, and gives it up only when told to."""

    def answer(line: bytes, count: int) -> bytes:
        if line == ask_command():
            return format_sentence(replace(HELLO, tile=number))
        if line.startswith(b"$MARK") and b"replace" not in line:
            return format_sentence(NakSentence(number, "MARKED", "MARK"))
        return format_sentence(AckSentence(number, "MARK", marking))

    return Device(format_sentence(TileSentence(number, 100, 1, "4", 4, 30, "----", STATE)), answer)


def test_a_marking_is_of_one_board_and_for_good(capsys: pytest.CaptureFixture[str]) -> None:
    devices = [marked(1, ("2", "17")), marked(2, ("2", "17"))]
    assert set_in(devices, "board", "2.17") == 2
    assert "2 boards would be the same" in capsys.readouterr().err
    assert set_in(devices, "board", "2.18", "--tile", "2") == 1
    assert "it has another marking; --replace replaces it" in capsys.readouterr().out
    assert set_in(devices, "board", "2.18", "--tile", "2", "--replace") == 0
    assert not any(line.startswith(b"$MARK") for line in devices[0].heard)


def test_what_only_some_models_can_show_is_refused_with_the_reason(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert set_in([tile(1)], "leds", "2") == 1
    assert "flash one trained with --recipe damage" in capsys.readouterr().out
