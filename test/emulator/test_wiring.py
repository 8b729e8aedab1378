"""The cables between the tiles of a shape."""

from tilenca.base.sides import EAST, NORTH, SOUTH, WEST
from tilenca.emulator.wiring import cables
from tilenca.shapes.file import Shape


def test_every_two_neighbours_have_one_cable() -> None:
    square = Shape("8", ("##", "##"), "8")
    assert cables(square) == [
        (0, EAST, 1, WEST),
        (0, SOUTH, 2, NORTH),
        (1, SOUTH, 3, NORTH),
        (2, EAST, 3, WEST),
    ]


def test_a_gap_has_no_cable_across_it() -> None:
    ring = Shape("0", ("###", "#.#", "###"), "0")
    assert len(cables(ring)) == 8
    assert (3, EAST, 4, WEST) not in cables(ring)


def test_a_tile_alone_has_none() -> None:
    assert cables(Shape("1", ("#",), "1")) == []
