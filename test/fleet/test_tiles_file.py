"""`tiles.toml`: what is written is read back, and what is wrong is named with its line."""

import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from support.refusal import read_or_refused
from support.strategies import damaged
from tilenca.base.errors import UsageError
from tilenca.fleet.tiles_file import HEAD, Place, format_tiles, read_tiles, write_tiles

names = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), min_size=1).map(
    lambda text: f"port:{text}"
)
fleets = st.lists(
    st.tuples(st.integers(1, 255), names, st.tuples(st.integers(-9, 99), st.integers(-9, 99))),
    unique_by=(lambda tile: tile[0], lambda tile: tile[1], lambda tile: tile[2]),
).map(lambda tiles: [Place(tile, name, row, col) for tile, name, (row, col) in tiles])


@given(fleets)
def test_any_board_name_becomes_toml_and_comes_back(places: list[Place]) -> None:
    tables = tomllib.loads(format_tiles(places)).get("tile", [])
    found = {Place(table["id"], table["board"], table["row"], table["col"]) for table in tables}
    assert found == set(places)


def test_a_file_is_read_as_it_was_written_in_reading_order(tmp_path: Path) -> None:
    places = [Place(7, "serial:A1", 1, 0), Place(3, "location:1-2.3:1.0", 0, 2), Place(9, "port:/t/9", 0, 1)]
    path = tmp_path / "tiles.toml"
    write_tiles(path, places)
    assert [place.tile for place in read_tiles(path)] == [9, 3, 7]
    assert set(read_tiles(path)) == set(places)
    assert list(tmp_path.iterdir()) == [path]


@given(fleets)
def test_any_fleet_is_read_back_as_it_was_written(
    tmp_path_factory: pytest.TempPathFactory, places: list[Place]
) -> None:
    path = tmp_path_factory.mktemp("fuzz") / "tiles.toml"
    write_tiles(path, places)
    assert set(read_tiles(path)) == set(places)


GOOD = '[[tile]]\nid = 1\nrow = 0\ncol = 0\nboard = "serial:A"\n'


@pytest.mark.parametrize(
    ("more", "complaint"),
    [
        (GOOD, ":8: two tiles have the id 1"),
        (GOOD.replace("id = 1", "id = 2"), ":8: tiles 1 and 2 are the same board"),
        (GOOD.replace("id = 1", "id = 2").replace("A", "B"), ":8: tiles 1 and 2 lie at the same place"),
        (GOOD.replace("id = 1", "id = 0"), ":8: id 0 is not from 1 to 255"),
        (GOOD.replace("id = 1", "id = 1.5"), ":8: id, row and col are whole numbers"),
        (GOOD.replace("serial:A", "COM3"), ":8: board is "),
        (GOOD.replace("serial:A", "port:\\u0000"), ":8: board is "),
        (GOOD.replace("row = 0", "row = 1000"), ":8: row and col are from -999 to 999"),
        (GOOD.replace("row", "line"), ":8: a .* has id, row, col and board"),
        ("[lab]\n", ": only .* belong here"),
        ("tile = \n", ": .*line 8"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(more: str, complaint: str, tmp_path: Path) -> None:
    path = tmp_path / "tiles.toml"
    path.write_text(HEAD[: HEAD.index("\n") + 1] + "\n" + GOOD + more)
    with pytest.raises(UsageError, match=rf"^{path}{complaint}"):
        read_tiles(path)


def test_a_file_that_cannot_be_used_says_so(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"No such file.*--learn"):
        read_tiles(tmp_path / "none.toml")
    (tmp_path / "noise").write_bytes(b"\xff\xfe")
    with pytest.raises(UsageError, match="noise"):
        read_tiles(tmp_path / "noise")
    with pytest.raises(UsageError, match="--tiles"):
        write_tiles(tmp_path / "none" / "tiles.toml", [])


@given(damaged(GOOD.encode()))
def test_any_bytes_are_read_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    places = read_or_refused(tmp_path_factory.mktemp("fuzz") / "tiles.toml", content, read_tiles)
    assert all(isinstance(place, Place) for place in places or [])


@pytest.mark.parametrize("value", ["9" * 5000, "[" * 2000])
def test_a_number_or_a_list_without_end_is_refused(value: str, tmp_path: Path) -> None:
    path = tmp_path / "tiles.toml"
    path.write_text(f"tile = {value}\n")
    with pytest.raises(UsageError, match="too"):
        read_tiles(path)
