"""The four sides of a tile, in the order that neighbours have everywhere, also on the wire."""

NORTH, EAST, SOUTH, WEST = range(4)
SIDES = "NESW"
# Rows and columns from a tile to its neighbour on each side.
OFFSETS: tuple[tuple[int, int], ...] = ((-1, 0), (0, 1), (1, 0), (0, -1))


def opposite(side: int) -> int:
    """The side of the neighbour on `side` that touches this tile."""
    return (side + 2) % len(SIDES)
