"""Telling many tiles something at once: each does it, refuses, or says nothing."""

from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from support.scripted_port import Device
from tilenca.fleet.command import ATTEMPTS, Reply, command_all
from tilenca.fleet.reader import PortReader
from tilenca.protocol.commands import set_command
from tilenca.protocol.sentences import (
    AckSentence,
    NakSentence,
    TileSentence,
    format_sentence,
)

STATE = format_sentence(TileSentence(7, 100, 1, "4", 4, 30, "----", bytes([128] * 21)))
ORDER = set_command("period", 20)


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def ack(line: bytes, count: int) -> bytes:
    return STATE + format_sentence(AckSentence(7, "SET", ("period", "20")))


def refuse(line: bytes, count: int) -> bytes:
    return format_sentence(NakSentence(7, "EEPROM", "SET"))


def damaged_at_first(line: bytes, count: int) -> bytes:
    return format_sentence(NakSentence(7, "CHECKSUM")) if count == 1 else ack(line, count)


def test_a_command_is_acknowledged_refused_or_said_again(stack: ExitStack) -> None:
    devices = [stack.enter_context(Device(answer=answer)) for answer in (ack, refuse, damaged_at_first)]
    deaf = stack.enter_context(Device())
    orders = {device.port: ORDER for device in (*devices, deaf)}
    with PortReader(list(orders), user="a test") as reader:
        while len(reader.open) < len(orders):
            reader.poll(0.1)
        replies = command_all(reader, orders, "SET")
    assert list(replies) == list(orders)
    assert replies[devices[0].port] == replies[devices[2].port] == Reply(("period", "20"))
    assert replies[devices[1].port].problem == "refused: SET: the EEPROM did not keep it"
    assert replies[deaf.port].problem == f"no answer to {ATTEMPTS} commands"
    assert [len(device.heard) for device in (*devices, deaf)] == [1, 1, 2, ATTEMPTS]
    assert {line for device in devices for line in device.heard} == {ORDER}
