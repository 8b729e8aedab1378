"""Where tiles lie, from what they say of their neighbours."""

import pytest

from tilenca.base.paths import SHAPES
from tilenca.base.sides import SIDES, opposite
from tilenca.fleet.layout import arrange
from tilenca.shapes.file import Shape, load_task

FACING = {side: SIDES[opposite(index)] for index, side in enumerate(SIDES)}


def heard(*joints: tuple[int, str, int]) -> dict[int, dict[str, tuple[int, str]]]:
    """Tile, side, neighbour: both hear each other."""
    about: dict[int, dict[str, tuple[int, str]]] = {}
    for tile, side, other in joints:
        about.setdefault(tile, {})[side] = (other, FACING[side])
        about.setdefault(other, {})[FACING[side]] = (tile, side)
    return about


@pytest.mark.parametrize("shape", load_task(SHAPES / "digits.toml").shapes, ids=lambda shape: shape.name)
def test_every_digit_is_found_from_who_hears_whom(shape: Shape) -> None:
    about = {
        tile + 1: {
            side: (other + 1, FACING[side])
            for side, other in zip(SIDES, neighbours, strict=True)
            if other >= 0
        }
        for tile, neighbours in enumerate(shape.neighbours())
    }
    found = arrange(about)
    assert found.cells == dict(enumerate(shape.cells, start=1))
    assert (len(found.groups), found.conflicts) == (1, [])


def test_one_direction_is_enough_and_a_tile_without_a_port_has_its_place() -> None:
    found = arrange({1: {"E": (2, "W")}})
    assert found.cells == {1: (0, 0), 2: (0, 1)}
    assert arrange({1: {}, 2: {"W": (1, "E")}}).cells == {1: (0, 0), 2: (0, 1)}


def test_groups_lie_beside_each_other_the_largest_first() -> None:
    found = arrange(heard((1, "S", 2), (2, "E", 3)) | {7: {}})
    assert found.groups == [[1, 2, 3], [7]]
    assert found.cells == {1: (0, 0), 2: (1, 0), 3: (1, 1), 7: (0, 3)}


def test_what_does_not_fit_is_told_and_ends_nothing() -> None:
    turned = arrange({1: {"E": (2, "N")}, 2: {"N": (1, "E")}})
    assert turned.conflicts[0] == "side E of tile 1 is joined to side N of tile 2"
    assert set(turned.cells) == {1, 2}
    twice = arrange(heard((1, "E", 2), (1, "S", 3)) | {3: {"N": (1, "S"), "W": (2, "E")}})
    assert any("elsewhere too" in conflict for conflict in twice.conflicts)
    square = arrange(heard((1, "E", 2), (2, "S", 3), (1, "S", 4), (4, "E", 5)))
    assert any("same place" in conflict for conflict in square.conflicts)
