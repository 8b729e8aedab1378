"""The monitor's picture: every tile in its place, with what it shows and how its links do."""

from support.heard_fleet import STATE, HeardFleet, link, three_in_an_l
from tilenca.fleet.boards import Board, Found
from tilenca.fleet.grid import Grid, Laid, Mark
from tilenca.fleet.ports import Port
from tilenca.fleet.state import PortNews
from tilenca.fleet.tiles_file import Place
from tilenca.protocol.sentences import (
    LinkSentence,
    TileSentence,
)
from tilenca.shapes.glyphs import look_of


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


def test_a_recording_says_where_tiles_lie_before_the_file_and_the_tiles() -> None:
    fleet = three_in_an_l().fleet
    grid = Grid([Place(1, "port:a", 0, 3)])
    for column, port in enumerate("abx"):
        grid.lay(port, Laid((5, column), column + 1))
    cells = grid.cells(fleet, 1.5)
    assert {place: cell.tile for place, cell in cells.items()} == {(5, 0): 1, (5, 1): 2, (5, 2): 3, (6, 0): 3}
    assert (cells[5, 2].trouble, cells[5, 2].port) == ("silent", "x"), "it never spoke"
    grid.lay("c", Laid((5, 2), 3))
    assert len(grid.cells(fleet, 1.5)) == 3, "where it lies now nobody else does"
    grid.lay("c", None)
    assert {cell.port for cell in grid.cells(fleet, 1.5).values()} == {"a", "b"}


def test_what_the_file_says_is_known_of_the_boards_that_are_there() -> None:
    places = [Place(1, "port:a", 0, 3), Place(2, "port:b", 1, 3)]
    grid = Grid(places)
    grid.know(Found([Board(Port("a"), "port:a", places[0]), Board(Port("x"), "port:x")]))
    assert grid.known() == {"a": Laid((0, 3), 1)}


def test_a_file_that_was_given_counts_more_than_a_recording() -> None:
    grid = Grid([Place(1, "port:a", 0, 3)], given=True)
    grid.lay("a", Laid((5, 5), 1))
    assert grid.cells(three_in_an_l().fleet, 1.5)[0, 3].tile == 1


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
    lab = HeardFleet()
    lab.open("a", "b")
    for port in ("a", "b"):
        lab.say(port, TileSentence(7, 100, 1, "4", 4, 30, "----", STATE))
    assert [cell.tile for cell in Grid().cells(lab.fleet, 1.0).values()] == [7, 7]


def test_the_colour_is_that_of_the_class_which_the_tile_decided_for() -> None:
    """The state's greatest score is the fifth class's; the tile decides by finer scores than it sends."""
    lab = HeardFleet()
    lab.open("a")
    for label, index, colour in (
        ("A", 2, look_of("A", 2).colour),
        ("7", 0, look_of("7", 7).colour),
        ("", None, (0, 0, 0)),
    ):
        lab.say("a", TileSentence(1, 100, 1, label, index, None, "----", STATE))
        (cell,) = Grid().cells(lab.fleet, 1.0).values()
        assert cell.colour == colour
