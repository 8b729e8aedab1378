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
from tilenca.page.watched import TAKES, Watch, WatchedSource
from tilenca.protocol import stream_commands as commands
from tilenca.protocol.sentences import framed
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
        page.source.take(commands.Blink(tiles[1].port))
    tiles[0].unplug()
    page.wait_for(open_of(tiles[0].port, False))
    with pytest.raises(UsageError, match="no tile can be reached"):
        page.source.take(commands.Set("period", 20))


def test_a_tile_that_speaks_is_asked_what_it_runs(page: Page, tiles: list[Tile]) -> None:
    page.wait_for(open_of(tiles[0].port, True))
    tiles[0].say()
    assert tiles[0].read_line() == framed("ASK").strip()


def test_a_command_reaches_its_tile_and_what_it_refuses_is_told(page: Page, tiles: list[Tile]) -> None:
    for tile in tiles:
        page.wait_for(open_of(tile.port, True))
    page.source.take(commands.Set("period", 50, None))
    for tile in tiles:
        assert tile.read_line() == framed("SET,period,50").strip()
        tile.write(framed(f"ACK,{tile.tile},SET,period,50"))
    for tile in tiles:
        assert tile.read_line() == framed("ASK").strip(), "so that the page knows what is in force"
    for command, line in (
        (commands.Blink(tiles[0].port, 3), "BLINK,3"),
        (commands.Restart(tiles[0].port), "RESTART"),
        (commands.Freeze(tiles[0].port, True), "SET,updates,1"),
    ):
        page.source.take(command)
        assert tiles[0].read_line() == framed(line).strip()
        name = line.split(",")[0]
        tiles[0].write(framed(f"NAK,1,VALUE,{name}"))
        refusal = page.wait_for(lambda event: "refused" in event)
        assert refusal["refused"].startswith(f"{tiles[0].port}: refused: ")


def test_what_only_a_hand_can_do_is_refused(page: Page) -> None:
    for command in (commands.Pull("x"), commands.Noise(0.1), commands.Open(((0, 0),)), commands.Seek(1)):
        with pytest.raises(UsageError, match="real tiles"):
            page.source.take(command)


def test_a_watch_that_breaks_off_says_so(
    watch: Watch, page: Page, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken(timeout_s: float) -> list[object]:
        raise ZeroDivisionError("no such share")

    monkeypatch.setattr(watch._listener, "poll", broken)
    refusal = page.wait_for(lambda event: "refused" in event)["refused"]
    assert refusal == "the tiles are not read any more: ZeroDivisionError: no such share"
    assert "Traceback" in capsys.readouterr().err
