"""What `tiles.toml` says after learning: boards that were not seen keep their entries."""

import pytest

from tilenca.base.errors import TilencaError
from tilenca.fleet.tiles_file import Place, tile_count, tile_list
from tilenca.fleet.tiles_update import update

ROW = [Place(tile, f"serial:{tile}", 2, tile) for tile in range(1, 6)]


def test_when_all_are_heard_the_file_is_what_was_learnt() -> None:
    moved = [Place(tile, f"serial:{tile}", tile, 0) for tile in range(1, 6)]
    new = update(ROW, moved, [], fixed=False)
    assert (new.places, new.remarks) == (moved, [])


def test_one_tile_alone_stays_where_it_was_and_so_do_the_others() -> None:
    new = update(ROW, [Place(3, "serial:3", 0, 0)], [*ROW[:2], *ROW[3:]], fixed=False)
    assert sorted(new.places, key=lambda place: place.tile) == ROW
    assert new.remarks == ["kept as they were, since they were not learnt now: tiles 1, 2, 4, 5"]


def test_a_row_that_grew_lies_where_most_of_it_was() -> None:
    learnt = [Place(tile, f"serial:{tile}", 0, tile - 2) for tile in range(2, 8)]
    new = update(ROW, learnt, ROW[:1], fixed=False)
    assert {place.tile: (place.row, place.col) for place in new.places} == {t: (2, t) for t in range(1, 8)}


def test_a_new_board_lies_beside_all_else_and_that_is_told() -> None:
    new = update(ROW, [Place(9, "serial:9", 0, 0)], ROW, fixed=False)
    assert new.places[0] == Place(9, "serial:9", 2, 7)
    assert new.remarks[0] == "the place of tile 9 beside the others is a guess; edit the file"


def test_a_tile_with_the_id_of_one_that_is_away_takes_its_entry_and_that_is_told() -> None:
    new = update(ROW, [Place(5, "serial:new", 2, 5)], ROW, fixed=True)
    assert new.places == [Place(5, "serial:new", 2, 5), *ROW[:4]]
    assert new.remarks[0] == "tile 5 was serial:5 before, and is another board now"


def test_two_tiles_at_one_place_are_refused_with_what_to_do() -> None:
    with pytest.raises(TilencaError, match=r"tile 9 lies where tile 3 \(serial:3\), .* at 2,3; remove its"):
        update(ROW, [Place(9, "serial:9", 2, 3)], ROW, fixed=True)


def test_tiles_in_words() -> None:
    assert [tile_count(0), tile_count(1), tile_count(20)] == ["0 tiles", "1 tile", "20 tiles"]
    assert tile_list([7, 3, 12, 10, 9, 11]) == "tiles 3, 7, 9-12"
    assert tile_list([4, 5]) == "tiles 4, 5"
    assert tile_list([4]) == "tile 4"
