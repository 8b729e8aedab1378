"""Orders of pages: each goes to the tiles that can take it, in its turn, and what goes wrong is told."""

import time
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from support.scripted_port import Device
from tilenca.base.errors import UsageError
from tilenca.fleet.reader import PortReader
from tilenca.fleet.state import Fleet, PortNews
from tilenca.page.orders import MOST_ORDERS, UNREACHED, Order, Orders
from tilenca.protocol.commands import set_command
from tilenca.protocol.sentences import AckSentence, TileSentence, format_sentence
from tilenca.protocol.stream import StreamEvent

LIMIT_S = 60
STATE = format_sentence(TileSentence(7, 100, 1, "4", 4, 30, "----", bytes([128] * 21)))


def ack(line: bytes, count: int) -> bytes:
    value = line.split(b",")[2].split(b"*")[0].decode()
    return STATE + format_sentence(AckSentence(7, "SET", ("period", value)))


class Table:
    """Two devices that answer, their fleet, and what orders have led to."""

    def __init__(self, stack: ExitStack) -> None:
        self.devices = [stack.enter_context(Device(answer=ack)) for _ in range(2)]
        self.ports = [device.port for device in self.devices]
        self.reader = stack.enter_context(PortReader(self.ports, user="a test"))
        self.fleet = Fleet()
        self.done: list[str] = []
        self.told: list[StreamEvent] = []
        self.orders = Orders(self.reader, self.fleet, lambda order, port: self.done.append(port))
        while len(self.reader.open) < len(self.ports):
            self.poll()

    def poll(self) -> None:
        for event in self.reader.poll(0.05):
            self.fleet.take(event)
            self.orders.take(event)

    def order(self, value: int, port: str | None) -> None:
        self.orders.add(Order("SET", set_command("period", value), port, self.told.extend))

    def run(self, done: int) -> None:
        end_s = time.monotonic() + LIMIT_S
        while len(self.done) < done:
            assert time.monotonic() < end_s, (self.done, self.told)
            self.orders.go_on()
            self.poll()


@pytest.fixture
def table() -> Iterator[Table]:
    with ExitStack() as stack:
        yield Table(stack)


def test_one_for_all_goes_only_to_tiles_that_have_spoken(table: Table) -> None:
    with pytest.raises(UsageError, match=UNREACHED):
        table.order(20, None)
    table.order(20, table.ports[0])
    table.run(1)
    table.order(30, None)
    table.run(2)
    assert table.done == [table.ports[0]] * 2
    assert [len(device.heard) for device in table.devices] == [2, 0], "another device may be no tile"


def test_they_come_in_turn_and_only_so_many_wait(table: Table) -> None:
    for number in range(MOST_ORDERS):
        table.order(20 + number, table.ports[0])
    with pytest.raises(UsageError, match="wait a moment"):
        table.order(20, table.ports[1])
    table.run(MOST_ORDERS)
    assert table.devices[0].heard == [set_command("period", 20 + number) for number in range(MOST_ORDERS)]


def test_one_whose_tile_goes_before_its_turn_is_answered(table: Table) -> None:
    table.order(20, table.ports[0])
    table.fleet.take(PortNews(0.0, table.ports[0], False, "went away"))
    table.orders.go_on()
    assert [event["refused"] for event in table.told] == [f"{table.ports[0]}: went away"]
    with pytest.raises(UsageError, match=r"cannot be reached now \(went away\)"):
        table.order(20, table.ports[0])
