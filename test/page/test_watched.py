"""Real tiles behind pages: read once for all of them, and told what a tile can be told."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from support.tile_port import Tile
from tilenca.base.errors import UsageError
from tilenca.fleet.listen import Listener
from tilenca.fleet.recording import Recorder, read_recording
from tilenca.page.session import EndedError
from tilenca.page.watched import TAKES, Watch, WatchedSource
from tilenca.protocol import stream_commands as commands
from tilenca.protocol import stream_hands as hands
from tilenca.protocol.constants import PROTOCOL_VERSION
from tilenca.protocol.sentences import HelloSentence, format_sentence, framed
from tilenca.protocol.stream import StreamEvent
from tilenca.protocol.stream_commands import KINDS

LIMIT_S = 60


@pytest.fixture
def tiles() -> Iterator[list[Tile]]:
    with ExitStack() as stack:
        yield [stack.enter_context(Tile(number)) for number in (1, 2)]


@pytest.fixture
def watch(tiles: list[Tile], tmp_path: Path) -> Iterator[Watch]:
    with ExitStack() as stack:
        listener = stack.enter_context(Listener([tile.port for tile in tiles], None))
        record = stack.enter_context(Recorder(tmp_path / "record.jsonl", "a"))
        yield stack.enter_context(Watch(listener, tuple("0123456789"), lambda model: None, record))


class Page:
    """A page that looks at a watch."""

    def __init__(self, watch: Watch) -> None:
        self.source = WatchedSource(watch)
        self.events: list[StreamEvent] = self.source.begin()

    def wait_for(self, what: Callable[[StreamEvent], bool]) -> StreamEvent:
        """The first event of that kind, of those that have not been waited for."""
        end_s = time.monotonic() + LIMIT_S
        while time.monotonic() < end_s:
            for place, event in enumerate(self.events):
                if what(event):
                    del self.events[: place + 1]
                    return event
            threading.Event().wait(0.01)
            self.events += self.source.advance(0.01)
        raise AssertionError(f"it never came; there are {self.events}")


@pytest.fixture
def page(watch: Watch) -> Iterator[Page]:
    made = Page(watch)
    yield made
    made.source.close()


def open_of(port: str, is_open: bool) -> Callable[[StreamEvent], bool]:
    return lambda event: event.get("port") == port and event.get("open") is is_open


def raw_of(port: str, name: str) -> Callable[[StreamEvent], bool]:
    return lambda event: event.get("port") == port and event.get("raw", "").startswith(f"${name}")


def test_it_says_first_what_it_is_and_what_it_takes(page: Page) -> None:
    first, run = page.events[:2]
    assert (first["source"], first["takes"]) == ("watched", list(TAKES))
    assert set(TAKES) <= set(KINDS)
    assert run["run"]["began"] == pytest.approx(time.time(), abs=LIMIT_S)


def test_what_a_tile_says_is_told_to_all_pages_and_recorded(
    page: Page, watch: Watch, tiles: list[Tile], tmp_path: Path
) -> None:
    page.wait_for(open_of(tiles[0].port, True))
    tiles[0].say("7")
    page.wait_for(raw_of(tiles[0].port, "TILE"))
    place = page.wait_for(lambda event: "place" in event and event.get("tile") == 1)
    assert place["port"] == tiles[0].port
    assert page.wait_for(lambda event: "pace" in event)["pace"] == {
        "speed": 1.0,
        "paused": False,
        "share": 1.0,
    }
    other = Page(watch)
    assert any(raw_of(tiles[0].port, "TILE")(event) for event in other.events), (
        "who comes later knows it, too"
    )
    other.source.close()
    tiles[0].say("8")
    page.wait_for(raw_of(tiles[0].port, "TILE"))
    heard = [event for event in read_recording(tmp_path / "record.jsonl") if hasattr(event, "raw")]
    assert [event.raw.split(b",")[4] for event in heard] == [b"7", b"8"]


def test_a_port_that_is_pulled_is_told_and_the_other_goes_on(page: Page, tiles: list[Tile]) -> None:
    for tile in tiles:
        page.wait_for(open_of(tile.port, True))
    tiles[1].say()
    page.wait_for(raw_of(tiles[1].port, "TILE"))
    tiles[1].unplug()
    gone = page.wait_for(open_of(tiles[1].port, False))
    assert "went away" in gone["reason"]
    tiles[0].say()
    page.wait_for(raw_of(tiles[0].port, "TILE"))
    with pytest.raises(UsageError, match="cannot be reached now"):
        page.source.take(hands.Blink(tiles[1].port))
    tiles[0].unplug()
    page.wait_for(open_of(tiles[0].port, False))
    with pytest.raises(UsageError, match="no tile can be reached"):
        page.source.take(hands.Set("period", 20))


def test_a_tile_that_speaks_is_asked_what_it_runs(page: Page, tiles: list[Tile]) -> None:
    page.wait_for(open_of(tiles[0].port, True))
    tiles[0].say()
    assert tiles[0].read_line() == framed("ASK").strip()


def test_a_command_reaches_its_tile_and_what_it_refuses_is_told(page: Page, tiles: list[Tile]) -> None:
    for tile in tiles:
        page.wait_for(open_of(tile.port, True))
    for tile in tiles:
        tile.say()
        assert tile.read_line() == framed("ASK").strip()
    page.wait_for(raw_of(tiles[1].port, "TILE"))
    page.source.take(hands.Set("period", 50, None))
    for tile in tiles:
        assert tile.read_line() == framed("SET,period,50").strip()
        tile.write(framed(f"ACK,{tile.tile},SET,period,50"))
    for tile in tiles:
        assert tile.read_line() == framed("ASK").strip(), "so that the page knows what is in force"
    for command, line in (
        (hands.Blink(tiles[0].port, 3), "BLINK,3"),
        (hands.Restart(tiles[0].port), "RESTART"),
        (hands.Freeze(tiles[0].port, True), "SET,updates,1"),
    ):
        page.source.take(command)
        assert tiles[0].read_line() == framed(line).strip()
        name = line.split(",")[0]
        tiles[0].write(framed(f"NAK,1,VALUE,{name}"))
        refusal = page.wait_for(lambda event: "refused" in event)
        assert refusal["refused"].startswith(f"{tiles[0].port}: refused: ")


def test_what_only_a_hand_can_do_is_refused(page: Page) -> None:
    for command in (hands.Pull("x"), hands.Noise(0.1), commands.Open(((0, 0),)), commands.Seek(1)):
        with pytest.raises(UsageError, match="real tiles"):
            page.source.take(command)


def test_a_watch_that_breaks_off_says_so(
    watch: Watch, page: Page, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken(timeout_s: float) -> list[object]:
        raise ZeroDivisionError("no such share")

    monkeypatch.setattr(watch._listener, "poll", broken)
    why = "the tiles are not read any more: ZeroDivisionError: no such share"
    with pytest.raises(EndedError, match=why):
        page.wait_for(lambda event: False)
    assert "Traceback" in capsys.readouterr().err
    with pytest.raises(EndedError, match=why):
        page.source.take(hands.Set("period", 50))
    late = WatchedSource(watch)
    with pytest.raises(EndedError, match=why):
        late.begin()
    late.close()


def test_a_tile_that_does_not_answer_holds_up_no_other_and_no_news(page: Page, tiles: list[Tile]) -> None:
    mute, well = tiles
    for tile in tiles:
        page.wait_for(open_of(tile.port, True))
    page.source.take(hands.Blink(mute.port, 3))
    assert mute.read_line() == framed("BLINK,3").strip()
    page.source.take(hands.Blink(mute.port, 4))
    page.source.take(hands.Blink(well.port, 5))
    assert well.read_line() == framed("BLINK,5").strip()
    well.write(framed("ACK,2,BLINK,5"))
    paces = 0
    while not (event := page.wait_for(lambda event: "pace" in event or "refused" in event)).get("refused"):
        paces += 1
    assert event["refused"] == f"{mute.port}: no answer to 3 commands"
    assert paces > 5, "time goes on meanwhile"
    assert [mute.read_line() for _ in range(3)] == [framed(f"BLINK,{s}").strip() for s in (3, 3, 4)]


def test_it_ends_though_a_tile_does_not_answer(tiles: list[Tile], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tilenca.fleet.command.AGAIN_S", 1000.0)
    with Listener([tiles[0].port], None) as listener:
        watch = Watch(listener, tuple("0123456789"), lambda model: None)
        with watch:
            page = Page(watch)
            page.wait_for(open_of(tiles[0].port, True))
            page.source.take(hands.Blink(tiles[0].port, 3))
            tiles[0].read_line()
            leaving_s = time.monotonic()
        assert time.monotonic() - leaving_s < LIMIT_S


def test_thaw_brings_back_what_was_set_before_freeze(page: Page, tiles: list[Tile]) -> None:
    page.wait_for(open_of(tiles[0].port, True))
    tiles[0].write(format_sentence(HelloSentence(PROTOCOL_VERSION, 1, 0x1234, 21, 11, 20, 500, 1, 0, 255)))
    page.wait_for(raw_of(tiles[0].port, "HELLO"))
    for on, value in ((True, 1), (False, 500), (False, 0)):
        page.source.take(hands.Freeze(tiles[0].port, on))
        assert tiles[0].read_line() == framed(f"SET,updates,{value}").strip()
        tiles[0].write(framed(f"ACK,1,SET,updates,{value}"))
        assert tiles[0].read_line() == framed("ASK").strip()
