"""The cables between the tiles of a shape."""

from tilenca.base.sides import EAST, SOUTH, opposite
from tilenca.emulator.array import Link
from tilenca.shapes.file import Shape


def cables(shape: Shape) -> list[Link]:
    """One link for every pair of neighbouring tiles, numbered in reading order."""
    neighbours = shape.neighbours()
    return [
        (tile, side, neighbours[tile][side], opposite(side))
        for tile in range(len(neighbours))
        for side in (EAST, SOUTH)  # each cable once, from its western or northern tile
        if neighbours[tile][side] >= 0
    ]
