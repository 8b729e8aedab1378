"""The four sides, in the order of the wire."""

from tilenca.base.sides import EAST, NORTH, OFFSETS, SIDES, SOUTH, WEST, opposite


def test_letters_and_numbers_have_the_same_order() -> None:
    assert [SIDES[side] for side in (NORTH, EAST, SOUTH, WEST)] == ["N", "E", "S", "W"]


def test_opposite_sides_touch() -> None:
    for side, (down, right) in enumerate(OFFSETS):
        assert OFFSETS[opposite(side)] == (-down, -right)
        assert opposite(opposite(side)) == side
    assert (opposite(NORTH), opposite(EAST)) == (SOUTH, WEST)


def test_rows_grow_to_the_south_and_columns_to_the_east() -> None:
    assert (OFFSETS[SOUTH], OFFSETS[EAST]) == ((1, 0), (0, 1))
