"""The monitor's picture: every tile in its place, with what it shows and how its links do."""

from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from support.strategies import sentences
from tilenca.fleet.events import Reporter
from tilenca.fleet.grid import Cell, Grid, Mark
from tilenca.fleet.link_health import WINDOW_MS, LinkHealth
from tilenca.fleet.state import Event, Fleet, PortNews
from tilenca.fleet.tiles_file import Place
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import (
    HelloSentence,
    LinkSentence,
    OtherVersionSentence,
    Sentence,
    TileSentence,
)
from tilenca.shapes.glyphs import look_of
from tilenca.views.fleet_grid import age_text, full, short, small
from tilenca.views.fleet_live import LiveView

# Ten classes in the last ten channels; the fifth is the greatest.
STATE = bytes([128] * 15 + [200] + [100] * 5)
FACING = dict(zip("NESW", "SWNE", strict=True))


def link(
    tile: int, side: str, other: int | None, uptime_ms: int = 0, received: int = 0, lost: int = 0
) -> LinkSentence:
    facing = None if other is None else FACING[side]
    return LinkSentence(tile, uptime_ms, side, 0, received, 0, lost, 0, 9, 0, other, facing)


class Lab:
    """A fleet that is told what tiles say, and the news of it."""

    def __init__(self) -> None:
        self.fleet = Fleet()
        self.reporter = Reporter(self.fleet)
        self.news: list[str] = []

    def take(self, event: Event) -> None:
        self.fleet.take(event)
        self.news += [news.text for news in self.reporter.take(event)]

    def open(self, *ports: str) -> None:
        for port in ports:
            self.take(PortNews(0.0, port, is_open=True))

    def say(self, port: str, *sentences: Sentence, time_s: float = 1.0) -> None:
        for sentence in sentences:
            self.take(Heard(time_s, port, b"", sentence))


def three_in_an_l() -> Lab:
    lab = Lab()
    lab.open("a", "b", "c")
    lab.say("a", TileSentence(1, 100, 7, "4", 4, 30, "-ES-", STATE), link(1, "E", 2), link(1, "S", 3))
    lab.say("b", TileSentence(2, 100, 8, "4", 4, 30, "---W", STATE), link(2, "W", 1))
    lab.say("c", TileSentence(3, 100, 9, "9", 9, 30, "N---", STATE), link(3, "N", 1))
    return lab


def test_tiles_lie_where_their_neighbours_say() -> None:
    grid = Grid().cells(three_in_an_l().fleet, 1.5)
    assert {place: cell.tile for place, cell in grid.items()} == {(0, 0): 1, (0, 1): 2, (1, 0): 3}
    assert grid[0, 0].marks == {"N": Mark.NONE, "E": Mark.WELL, "S": Mark.WELL, "W": Mark.NONE}
    assert (grid[1, 0].label, grid[1, 0].updates, grid[1, 0].age_s) == ("9", 9, 0.5)
    assert grid[0, 0].colour == (5, 50, 30), "the digit 4 is aquamarine"


def test_the_file_says_where_tiles_lie_and_which_are_missing() -> None:
    places = [Place(1, "port:a", 0, 3), Place(2, "port:b", 1, 3), Place(9, "serial:x", 2, 3)]
    grid = Grid(places).cells(three_in_an_l().fleet, 1.5)
    assert {place: cell.tile for place, cell in grid.items()} == {(0, 3): 1, (1, 3): 2, (2, 3): 9, (3, 0): 3}
    assert grid[2, 3].trouble == "no port"


def test_a_link_that_should_be_there_is_marked_dead() -> None:
    lab = three_in_an_l()
    lab.say("b", TileSentence(2, 200, 9, "4", 4, 30, "----", STATE))
    grid = Grid().cells(lab.fleet, 1.5)
    assert grid[0, 1].marks["W"] is Mark.DEAD
    assert grid[0, 0].marks["E"] is Mark.WELL, "the other direction is another link"
    assert "lost its neighbour on W" in lab.news


def test_a_tile_with_another_model_is_marked_and_told_once_until_it_has_ours() -> None:
    lab = three_in_an_l()
    lab.say("a", TileSentence(1, 1000, 10, "4", 4, 30, "--S-", STATE))
    for second in range(1, 15):
        foreign = min(10 * second, 50)
        lab.say("a", LinkSentence(1, 1000 * second, "E", 0, 0, 0, 0, foreign, None, 0, None, None))
        if second == 4:
            assert Grid().cells(lab.fleet, 1.0)[0, 0].marks["E"] is Mark.FOREIGN
    assert [text for text in lab.news if "model" in text] == [
        "a tile with another model is on E: flash the one that differs from most (tilenca flash)"
    ]
    lab.say("a", LinkSentence(1, 16_000, "E", 0, 0, 0, 0, 50, None, 0, None, None))
    assert lab.news[-1] == "no other model is on E any more"


def test_without_the_file_tiles_stay_where_they_were_while_a_link_fails() -> None:
    lab, grid = three_in_an_l(), Grid()
    grid.cells(lab.fleet, 1.0)
    lab.say("a", TileSentence(1, 200, 9, "4", 4, 30, "--S-", STATE))
    lab.say("b", TileSentence(2, 200, 9, "4", 4, 30, "----", STATE))
    cells = grid.cells(lab.fleet, 1.5)
    assert {place: cell.tile for place, cell in cells.items()} == {(0, 0): 1, (0, 1): 2, (1, 0): 3}
    assert (cells[0, 0].marks["E"], cells[0, 1].marks["W"]) == (Mark.DEAD, Mark.DEAD)


def test_a_tile_that_was_moved_lies_where_it_is_now() -> None:
    lab, grid = three_in_an_l(), Grid()
    grid.cells(lab.fleet, 1.0)
    lab.say("a", TileSentence(1, 200, 9, "4", 4, 30, "--S-", STATE))
    lab.say("b", TileSentence(2, 200, 9, "4", 4, 30, "---W", STATE), link(2, "W", 3))
    lab.say("c", TileSentence(3, 200, 9, "9", 9, 30, "NE--", STATE), link(3, "E", 2))
    cells = grid.cells(lab.fleet, 1.5)
    assert {place: cell.tile for place, cell in cells.items()} == {(0, 0): 1, (1, 0): 3, (1, 1): 2}


def test_silent_and_absent_tiles_are_marked_and_one_that_came_back_elsewhere_is_drawn_once() -> None:
    lab = three_in_an_l()
    lab.take(PortNews(2.0, "c", is_open=False, reason="went away"))
    grid = Grid().cells(lab.fleet, 9.0)
    assert {cell.tile: cell.trouble for cell in grid.values()} == {1: "silent", 2: "silent", 3: "away"}
    lab.open("c2")
    lab.say("c2", TileSentence(3, 100, 1, "4", 4, 30, "N---", STATE), time_s=9.0)
    again = Grid().cells(lab.fleet, 9.0)
    assert [cell.trouble for cell in again.values() if cell.tile == 3] == [""]


def test_tiles_with_the_same_id_are_both_drawn() -> None:
    lab = Lab()
    lab.open("a", "b")
    for port in ("a", "b"):
        lab.say(port, TileSentence(7, 100, 1, "4", 4, 30, "----", STATE))
    assert [cell.tile for cell in Grid().cells(lab.fleet, 1.0).values()] == [7, 7]


def test_health_is_of_the_last_seconds_and_is_told_before_the_link_is_gone() -> None:
    lab = three_in_an_l()
    received = lost = 0
    for second in range(40):
        received, lost = received + (10 if second < 20 else 8), lost + (0 if second < 20 else 2)
        lab.say("a", link(1, "E", 2, 1000 * second, received, lost))
    assert [text for text in lab.news if "failing" in text] == [
        "link E is failing: 12% of the frames get lost"
    ]
    assert Grid().cells(lab.fleet, 1.0)[0, 0].marks["E"] is Mark.FAILING
    for second in range(40, 55):
        received += 10
        lab.say("a", link(1, "E", 2, 1000 * second, received, lost))
    assert lab.news[-1] == "link E is well again"


def test_health_begins_anew_when_a_tile_restarts() -> None:
    health = LinkHealth()
    assert health.good is None
    for uptime_ms, received, lost in ((0, 100, 0), (1000, 100, 100), (500, 5, 0), (500 + WINDOW_MS, 15, 0)):
        health.take(link(1, "E", 2, uptime_ms, received, lost))
    assert health.good == 1.0


def test_the_log_tells_what_changed_and_nothing_twice() -> None:
    lab = Lab()
    lab.open("a")
    for label in ("4", "4", "9", "9"):
        lab.say("a", TileSentence(1, 100, 1, label, int(label), 30, "----", STATE))
    lab.say("a", HelloSentence(3, 1, 0, 21, 10, 20, 0, 8, 0xABCD, 255))
    lab.take(Heard(1.0, "a", b"\x1bnoise", None))
    heads = [text.split(":")[0] for text in lab.news]
    assert heads == ["port open", "shows 4", "shows 9, before 4", "started", "damaged"]
    assert "watchdog" in lab.news[3]


def test_a_tile_of_another_version_is_told_once_until_it_starts_again_as_ours() -> None:
    lab = Lab()
    lab.open("a")
    lab.say("a", *[OtherVersionSentence(2, 1)] * 3)
    assert [text for text in lab.news if "protocol 2" in text] == [OtherVersionSentence(2, 1).remedy]
    lab.say("a", HelloSentence(3, 1, 0, 21, 10, 20, 0, 8, 0xABCD, 255), OtherVersionSentence(2, 1))
    assert len([text for text in lab.news if "these tools speak" in text]) == 2


def test_the_colour_is_that_of_the_class_which_the_tile_decided_for() -> None:
    """The state's greatest score is the fifth class's; the tile decides by finer scores than it sends."""
    lab = Lab()
    lab.open("a")
    for label, index, colour in (
        ("A", 2, look_of("A", 2).colour),
        ("7", 0, look_of("7", 7).colour),
        ("", None, (0, 0, 0)),
    ):
        lab.say("a", TileSentence(1, 100, 1, label, index, None, "----", STATE))
        (cell,) = Grid().cells(lab.fleet, 1.0).values()
        assert cell.colour == colour


said: st.SearchStrategy[Event] = st.one_of(
    st.builds(PortNews, st.just(1.0), st.sampled_from("abc"), st.booleans(), st.text(max_size=5)),
    st.builds(Heard, st.floats(0, 9), st.sampled_from("abc"), st.binary(max_size=9), st.none() | sentences),
)


@given(st.lists(said, max_size=30), st.integers(1, 90), st.integers(1, 40), st.booleans())
def test_whatever_is_heard_the_picture_fits_the_terminal(
    events: list[Event], width: int, height: int, table: bool
) -> None:
    lab = Lab()
    view = LiveView(lab.fleet, Grid(), Console(width=width, height=height), table)
    for event in events:
        lab.take(event)
        view.show(9.0, [event])
    lines = view.lines(width, height)
    assert len(lines) <= height
    assert all(line.cell_len <= width for line in lines)


def test_on_a_narrow_terminal_the_log_says_what_happens_and_not_where_ports_are() -> None:
    lab, port = Lab(), "/a/folder/far/away/from/all/others/tiles/tile-03"
    view = LiveView(lab.fleet, Grid(), Console(width=50, height=24), table=False)
    lab.open(port)
    for label in "49":
        said = Heard(1.0, port, b"", TileSentence(3, 100, 1, label, int(label), 30, "----", STATE))
        lab.take(said)
        view.show(1.0, [said])
    assert view.lines(50, 24)[-1].plain.endswith(" tile   3 tile-03 shows 9, before 4")


def test_boxes_and_lines_have_one_size_whatever_the_numbers() -> None:
    for updates in (None, 0, 999, 9999, 10_000, 999_999, 4_294_967_295):
        for age_s in (None, 0.5, 50.0, 5000.0, 1e6, 1e9):
            cell = Cell(255, "8", (1, 2, 3), updates, 0.05, age_s, "silent", {"E": Mark.DEAD})
            grid = {(0, 0): cell, (1, 1): Cell(None)}
            assert {len(line) for line in full(grid, ascii_only=False)[:5]} == {13}
            assert all(line.plain.isascii() for line in full(grid, ascii_only=True))
            assert len(small(grid)[0]) <= 10
    assert (short(12_345), age_text(0.5), age_text(7.2)) == ("12k", "", "7s")
