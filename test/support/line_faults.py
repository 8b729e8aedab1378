"""Lines that misbehave: what a side's receiving pin hears when no tile is at the other end."""

import random
from collections.abc import Iterator

from tilenca.emulator import EmulatedTile

CLOCK_HZ = 16e6
# Edges are handed over this long before they are due. An array runs in steps of 16 us, a bit longer than
# asked.
AHEAD_S = 0.001
STEP_S = 16e-6

# Seconds of the array's time, and the new level.
Edges = Iterator[tuple[float, bool]]


def random_bytes(baud: float, seed: int, start_s: float = 0.0) -> Edges:
    """A neighbour that sends whatever, without a pause."""
    draw = random.Random(seed)
    bit_s, time_s, level = 1 / baud, start_s, True
    while True:
        bits = draw.getrandbits(8) << 1 | 0x200
        for _ in range(10):
            if bool(bits & 1) != level:
                level = not level
                yield time_s, level
            bits >>= 1
            time_s += bit_s


def noise(edges_per_s: float, seed: int, start_s: float = 0.0) -> Edges:
    """A line that nobody drives, near something that hums: changes at random times."""
    draw = random.Random(seed)
    time_s, level = start_s, True
    while True:
        time_s += draw.expovariate(edges_per_s)
        level = not level
        yield time_s, level


def bursts(edges_per_s: float, seed: int, length_s: float, every_s: float, start_s: float = 0.0) -> Edges:
    """Such noise for a while, again and again, and a high line between."""
    number = 0
    while True:
        begin_s = start_s + number * every_s
        for time_s, level in noise(edges_per_s, seed + number, begin_s):
            if time_s >= begin_s + length_s:
                break
            yield time_s, level
        yield begin_s + length_s, True
        number += 1


class Vandal:
    """Plays edges to the receiving pin of a side without a cable."""

    def __init__(self, tile: EmulatedTile, side: int, edges: Edges, ppm: float = 0.0) -> None:
        self._tile, self._edges = tile, edges
        self._pin = tile.side_pin(side, receiving=True)
        self._cycles_per_s = CLOCK_HZ * (1 + ppm * 1e-6)
        self._next: tuple[float, bool] | None = next(edges)

    def play(self, now_s: float, until_s: float) -> None:
        """Hands over what is due before `until_s`; then run the array no further than that."""
        port, bit = self._pin
        push, rate = self._tile.push_edge, self._cycles_per_s
        while self._next is not None and self._next[0] < until_s + AHEAD_S:
            time_s, level = self._next
            if time_s >= now_s + AHEAD_S - 2 * STEP_S:
                push(port, bit, round(time_s * rate), level)
            self._next = next(self._edges, None)
