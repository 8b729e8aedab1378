"""A session: commands in, events out, and nothing that a source does brings it down."""

import threading

import pytest

from tilenca.base.errors import TilencaError, UsageError
from tilenca.page.session import MOST_COMMANDS, Session
from tilenca.protocol.stream import StreamEvent, place_event, stream_event
from tilenca.protocol.stream_commands import Pull, Put, Reset, StreamCommand

LIMIT_S = 20


class Scripted:
    """A source that does what commands say: Put tells of a place, Reset cannot, Pull ends all advance."""

    def __init__(self) -> None:
        self.told: list[StreamEvent] = []
        self.broken = self.closed = False
        self.in_take = threading.Event()
        self.go_on = threading.Event()
        self.go_on.set()

    def begin(self) -> list[StreamEvent]:
        return [stream_event("scripted")]

    def take(self, command: StreamCommand) -> None:
        self.in_take.set()
        assert self.go_on.wait(LIMIT_S)
        match command:
            case Put(row, col):
                self.told.append(place_event(0, "tile-01", (row, col)))
            case Reset():
                raise UsageError("no such tile")
            case Pull():
                self.broken = True

    def advance(self, wall_s: float) -> list[StreamEvent]:
        assert 0 <= wall_s <= 0.1
        if self.broken:
            self.broken = False
            raise TilencaError("tile 1 stopped")
        told, self.told = self.told, []
        return told

    @property
    def is_idle(self) -> bool:
        return True

    def close(self) -> None:
        self.closed = True


class Heard:
    """What a session delivers."""

    def __init__(self) -> None:
        self.events: list[StreamEvent] = []
        self.news = threading.Condition()

    def take(self, events: list[StreamEvent]) -> None:
        with self.news:
            self.events += events
            self.news.notify_all()

    def wait_for(self, count: int) -> list[StreamEvent]:
        with self.news:
            assert self.news.wait_for(lambda: len(self.events) >= count, LIMIT_S), self.events
            return self.events


def test_a_command_is_carried_out_and_one_that_cannot_be_is_refused() -> None:
    source, heard = Scripted(), Heard()
    session = Session(lambda: source, heard.take)
    assert heard.wait_for(1)[0]["source"] == "scripted"
    for command in (Reset("tile-09"), Pull("tile-01"), Put(2, 3)):
        assert session.offer(command)
    events = heard.wait_for(4)
    assert [event.get("refused") for event in events[1:]] == ["no such tile", "tile 1 stopped", None] or [
        event.get("refused") for event in events[1:]
    ] == ["no such tile", None, "tile 1 stopped"]
    session.close()
    assert source.closed


def test_more_commands_than_it_can_hold_are_not_taken() -> None:
    source, heard = Scripted(), Heard()
    source.go_on.clear()
    session = Session(lambda: source, heard.take)
    assert session.offer(Put(0, 0))
    assert source.in_take.wait(LIMIT_S)
    assert [session.offer(Put(0, 0)) for _ in range(MOST_COMMANDS)] == [True] * MOST_COMMANDS
    assert not session.offer(Put(0, 0))
    source.go_on.set()
    heard.wait_for(1 + MOST_COMMANDS + 1)
    session.close()


def test_a_source_that_cannot_be_made_is_one_line() -> None:
    def fail() -> Scripted:
        raise UsageError("firmware.elf: no such file")

    heard = Heard()
    session = Session(fail, heard.take)
    assert heard.wait_for(1)[0]["refused"] == "firmware.elf: no such file"
    session.close()


@pytest.mark.parametrize("length", [1, 5000])
def test_a_refusal_has_an_end(length: int) -> None:
    def fail() -> Scripted:
        raise UsageError("x" * length)

    heard = Heard()
    session = Session(fail, heard.take)
    assert len(heard.wait_for(1)[0]["refused"]) == min(length, 300)
    session.close()
