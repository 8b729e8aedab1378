"""A session: commands in, events out, and nothing that a source does brings it down."""

import threading

import pytest

from tilenca.base.errors import TilencaError, UsageError
from tilenca.page.session import MOST_COMMANDS, STEP_SLICE_S, EndedError, Session
from tilenca.protocol.stream import StreamEvent, place_event, stream_event
from tilenca.protocol.stream_commands import Step, StreamCommand
from tilenca.protocol.stream_hands import Blink, Pull, Put, Reset

LIMIT_S = 20


class Scripted:
    """A source that does what commands say: Put tells of a place, Reset cannot, Pull ends all advance."""

    def __init__(self) -> None:
        self.told: list[StreamEvent] = []
        self.broken = self.closed = False
        self.taken: list[StreamCommand] = []
        self.in_take = threading.Event()
        self.go_on = threading.Event()
        self.go_on.set()
        self.abandoned = threading.Event()

    def begin(self) -> list[StreamEvent]:
        return [stream_event("scripted")]

    def take(self, command: StreamCommand) -> None:
        self.taken.append(command)
        self.in_take.set()
        assert self.go_on.wait(LIMIT_S)
        match command:
            case Put(0, 1):
                raise ZeroDivisionError("no such share")
            case Put(row, col):
                self.told.append(place_event(0, "tile-01", (row, col)))
            case Reset():
                raise UsageError("no such tile")
            case Pull():
                self.broken = True
            case Blink():
                raise EndedError("nobody is there")

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

    def abandon(self) -> None:
        self.abandoned.set()

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


def test_one_that_is_closed_begins_no_command_that_waits() -> None:
    source, heard = Scripted(), Heard()
    source.go_on.clear()
    session = Session(lambda: source, heard.take)
    for _ in range(MOST_COMMANDS):
        session.offer(Step(10))
    assert source.in_take.wait(LIMIT_S)
    closing = threading.Thread(target=session.close)
    closing.start()
    assert session._ended.wait(LIMIT_S)
    assert closing.is_alive()  # its thread is still at work
    source.go_on.set()
    closing.join(LIMIT_S)
    assert not closing.is_alive()
    assert len(source.taken) == 1
    assert source.closed


@pytest.mark.parametrize("seconds", [16e-6, 0.02, 0.05, 0.1, 0.3, 0.3001, 10.0])
def test_a_step_is_made_of_short_ones(seconds: float) -> None:
    source, heard = Scripted(), Heard()
    session = Session(lambda: source, heard.take)
    session.offer(Step(seconds))
    session.offer(Put(2, 3))
    heard.wait_for(2)
    session.close()
    steps = [command.seconds for command in source.taken if isinstance(command, Step)]
    assert sum(steps) == pytest.approx(seconds)
    assert min(steps) > 0
    assert max(steps) <= STEP_SLICE_S
    assert len(steps) <= seconds / STEP_SLICE_S + 1


def test_a_mistake_in_a_source_is_told_and_ends_the_run(capsys: pytest.CaptureFixture[str]) -> None:
    source, heard, ended = Scripted(), Heard(), threading.Event()
    session = Session(lambda: source, heard.take, ended.set)
    session.offer(Put(0, 1))
    assert ended.wait(LIMIT_S)
    assert heard.events[-1]["refused"] == "the run broke off: ZeroDivisionError: no such share"
    assert source.closed
    assert "Traceback" in capsys.readouterr().err
    session.close()


@pytest.mark.parametrize("in_advance", [False, True])
def test_a_source_that_is_over_ends_the_run_with_its_reason(in_advance: bool) -> None:
    class Over(Scripted):
        def advance(self, wall_s: float) -> list[StreamEvent]:
            if in_advance:
                raise EndedError("nobody is there")
            return []

    source, heard, ended = Over(), Heard(), threading.Event()
    session = Session(lambda: source, heard.take, ended.set)
    session.offer(Blink("tile-01"))
    assert ended.wait(LIMIT_S)
    assert [event.get("refused") for event in heard.events] == [None, "nobody is there"]
    assert source.closed
    session.close()


def test_what_takes_long_is_abandoned_when_it_is_closed() -> None:
    class Long(Scripted):
        def advance(self, wall_s: float) -> list[StreamEvent]:
            assert self.abandoned.wait(LIMIT_S)
            return []

    source, heard = Long(), Heard()
    session = Session(lambda: source, heard.take)
    heard.wait_for(1)
    session.close()
    assert source.closed


@pytest.mark.parametrize("length", [1, 5000])
def test_a_refusal_has_an_end(length: int) -> None:
    def fail() -> Scripted:
        raise UsageError("x" * length)

    heard = Heard()
    session = Session(fail, heard.take)
    assert len(heard.wait_for(1)[0]["refused"]) == min(length, 300)
    session.close()
