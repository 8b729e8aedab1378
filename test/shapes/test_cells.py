"""The tiles of a drawing, and how they hang together."""

from hypothesis import given
from hypothesis import strategies as st

from tilenca.shapes.cells import apart, cells_of, connected, removable

RING = ("###", "#.#", "###")


def test_cells_are_in_reading_order() -> None:
    assert cells_of((".#", "##")) == ((0, 1), (1, 0), (1, 1))
    assert cells_of(("...",)) == ()


def test_corners_do_not_connect_and_sides_do() -> None:
    assert connected([(0, 0), (0, 1), (1, 1)])
    assert not connected([(0, 0), (1, 1)])
    assert connected([(5, 5)])
    assert connected([])
    assert apart([(0, 0), (0, 1), (1, 1), (3, 2)]) == (3, 2)
    assert apart([(0, 0), (2, 0), (2, 1)]) == (0, 0)


def test_of_a_line_only_the_ends_may_go_and_of_a_ring_every_tile() -> None:
    line = cells_of(("####",))
    assert removable(line) == [(0, 0), (0, 3)]
    assert removable(cells_of(RING)) == list(cells_of(RING))


def test_where_the_walk_begins_does_not_matter() -> None:
    cross = cells_of((".#.", "###", ".#."))
    ends = {(0, 1), (1, 0), (1, 2), (2, 1)}
    assert set(removable(cross)) == ends
    middle_first = [(1, 1), *(cell for cell in cross if cell != (1, 1))]
    assert set(removable(middle_first)) == ends


def test_of_two_tiles_either_may_go_and_one_alone_too() -> None:
    assert removable([(0, 0), (0, 1)]) == [(0, 0), (0, 1)]
    assert removable([(0, 0)]) == [(0, 0)]


@st.composite
def drawings(draw: st.DrawFn) -> list[tuple[int, int]]:
    """Connected cells, grown one by one."""
    cells = [(0, 0)]
    for number in draw(st.lists(st.integers(0, 10_000), max_size=25)):
        row, col = cells[number % len(cells)]
        down, right = ((-1, 0), (0, 1), (1, 0), (0, -1))[number // 7 % 4]
        if (cell := (row + down, col + right)) not in cells:
            cells.append(cell)
    return cells


@given(drawings())
def test_what_may_go_is_what_leaves_the_others_connected(cells: list[tuple[int, int]]) -> None:
    expected = [cell for cell in cells if connected([other for other in cells if other != cell])]
    assert removable(cells) == expected
