"""One run of tiles in plain Python, event by event: the reference for tools/simulator.

It is written from the description of the schedules, not from the code: times are fractions, every pair of
tiles has its messages, and it computes one run at a time.
"""

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.protocol.constants import SILENT_PERIODS
from tilenca.simulator.rollout_library import TICKS_PER_STEP, UNITS_PER_STEP, Setup, units

NEVER = Fraction(-(10**9))

Update = Callable[[NDArray[Any], NDArray[Any]], NDArray[Any]]  # (C,) state and (5 C,) inputs to (C,) state
Message = Callable[[NDArray[Any]], NDArray[Any]]


def split_mix(seed: int) -> Iterator[int]:
    """Steele, Lea & Flood, Fast splittable pseudorandom number generators (2014)."""
    mask = (1 << 64) - 1
    while True:
        seed = (seed + 0x9E3779B97F4A7C15) & mask
        z = ((seed ^ seed >> 30) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ z >> 27) * 0x94D049BB133111EB) & mask
        yield z ^ z >> 31


def _of_sides(latency: NDArray[np.float64]) -> list[list[Fraction]]:
    """Of each tile and side, from (N, 4), or from (N,) for all sides."""
    columns = latency if latency.ndim == 2 else np.stack([latency] * 4, axis=1)
    return [[Fraction(int(t), UNITS_PER_STEP) for t in row] for row in units(columns)]


class SlowRun:
    """One run.

    Args:
        setup: of all runs.
        run: the index of this one.
        states: (N, C) states of all runs to start from.
        seed_state: (C,) the state of a tile that was just switched on.
        update: the network.
        message: turns a state into the message to neighbours.
        classes: their number.
    """

    def __init__(
        self,
        setup: Setup,
        run: int,
        states: NDArray[Any],
        seed_state: NDArray[Any],
        update: Update,
        message: Message,
        classes: int,
    ) -> None:
        begin, end = setup.starts[run], setup.starts[run + 1]
        self.setup, self.seed_state, self.update, self.message, self.classes = (
            setup, seed_state, update, message, classes
        )  # fmt: skip
        self.tiles = range(end - begin)
        self.neighbours = [
            [int(other - begin) if other < len(setup.alive) else None for other in row]
            for row in setup.neighbours[begin:end]
        ]
        self.states = [state.copy() for state in states[begin:end]]
        self.on = [bool(alive) for alive in setup.alive[begin:end]]
        self.stuck = [False for _ in self.tiles]
        self.shown = [-1 for _ in self.tiles]
        self.received: dict[tuple[int, int], NDArray[Any]] = {}  # by (sender, receiver)
        self.received_at: dict[tuple[int, int], Fraction] = {}
        self.numbers = split_mix(int(setup.seeds[run]))
        self.now = Fraction(0)
        self.faulty = int(setup.faulty[run] - begin) if setup.faulty[run] >= 0 else None
        self.target = int(setup.target[begin])
        out = None if setup.fault == "away" else self.faulty  # a tile that was away counts when it is back
        self.counted = [tile for tile in self.tiles if self.on[tile] and tile != out]
        if self.faulty is not None and setup.begin == 0:
            if setup.fault == "stuck":
                self.stuck[self.faulty] = True
            else:
                self.on[self.faulty] = False
        self.was_alive = [bool(alive) for alive in setup.alive[begin:end]]
        self.own = [message(state) for state in self.states]
        self.changes = [
            (int(at), int(cell - begin), bool(on)) for at, cell, on in setup.changes if begin <= cell < end
        ]
        self.sending = [tile for tile in self.tiles if self.on[tile]]
        if setup.clocks:
            clocks = setup.clocks
            self.update_at = [Fraction(int(t), UNITS_PER_STEP) for t in units(clocks.first[begin:end])]
            self.period = [Fraction(int(t), UNITS_PER_STEP) for t in units(clocks.period[begin:end])]
            self.latency = _of_sides(clocks.latency[begin:end])
            seed_latency = clocks.latency if clocks.seed_latency is None else clocks.seed_latency
            self.seed_latency = _of_sides(seed_latency[begin:end])
            line = np.zeros(4) if clocks.line is None else clocks.line
            self.line = [Fraction(int(t), UNITS_PER_STEP) for t in units(line)]
            self.on_since = [NEVER for _ in self.tiles]
            self.arrive_at: list[dict[int, Fraction]] = [{} for _ in self.tiles]  # of each side still to come
            self.now = Fraction(int(clocks.start))
            # A tile that runs already has told its neighbours its state; another one is switched on later.
            self.boot_at: list[Fraction | None] = [None for _ in self.tiles]
            if not setup.running:
                for tile in self.sending:
                    self.boot_at[tile] = self.update_at[tile] - self.period[tile]
                    self.on[tile] = False
                self.sending = []

    def step(self) -> float:
        """Runs one step; returns the share of tiles that are right after it."""
        if self.setup.clocks:
            until = max(self.now, Fraction(0)) + 1
            while self.now < until:
                if self.now >= 0 and self.now.denominator == 1:
                    self._begin_step(int(self.now))
                self.now += Fraction(1, TICKS_PER_STEP)
                self._tick()
        elif self.setup.schedule == "listing":
            self._begin_step(int(self.now))
            self._listed_step()
            self.now += 1
        else:
            self._begin_step(int(self.now))
            for _ in range(2):
                self.now += Fraction(1, 2)
                self._half_step()
        return sum(self.shown[tile] == self.target for tile in self.counted) / len(self.counted)

    def _begin_step(self, step: int) -> None:
        self._change(step)
        for at, tile, on in self.changes:
            if at != step or on == self.on[tile]:
                continue
            if on:
                self._put_down(tile)
                self.counted.append(tile)
            else:
                self.on[tile] = False
                self.shown[tile] = -1
                self.counted.remove(tile)

    def _put_down(self, tile: int) -> None:
        """A tile is switched on: the seed state, no message of anybody, and its own one is on its way."""
        self._boot(tile)
        if self.setup.clocks:
            self.update_at[tile] = self.now + self.period[tile]
            self._tell(tile, self.now, self.seed_latency)
            self.on_since[tile] = self.now
        else:
            self.sending.append(tile)

    def _boot(self, tile: int) -> None:
        self.on[tile] = True
        self.states[tile] = self.seed_state.copy()
        self.own[tile] = self.message(self.states[tile])
        for other in self.neighbours[tile]:
            self.received.pop((other, tile), None)  # type: ignore[arg-type]

    def _change(self, step: int) -> None:
        tile, setup = self.faulty, self.setup
        if tile is None or not self.was_alive[tile]:
            return
        if setup.fault == "away" and step == setup.end:
            self._put_down(tile)
        elif step == setup.begin and step > 0:
            if setup.fault == "stuck":
                self.stuck[tile] = True
            else:
                self.on[tile] = False
                self.shown[tile] = -1

    def _tick(self) -> None:
        for tile in self.sending:
            if self.on[tile]:
                self._send(tile)
        self.sending, booted = [], []
        for tile in self.tiles:
            boot = self.boot_at[tile]
            if boot is not None and boot <= self.now:
                self.boot_at[tile] = None
                self._boot(tile)
                self._tell(tile, boot, self.seed_latency)
                self.on_since[tile] = boot
                booted.append(tile)
        for tile in self.tiles:
            arrived = {side: at for side, at in self.arrive_at[tile].items() if at <= self.now}
            if self.on[tile] and arrived and tile not in booted:
                for side in arrived:
                    del self.arrive_at[tile][side]
                self._send(tile, [side for side, at in arrived.items() if self._listened(tile, side, at)])
        due = [tile for tile in self.tiles if self.on[tile] and self.update_at[tile] <= self.now]
        for tile in due:
            self._update(tile)
            self._tell(tile, self.update_at[tile], self.latency)
            self.update_at[tile] += self.period[tile]

    def _tell(self, tile: int, at: Fraction, latency: list[list[Fraction]]) -> None:
        self.arrive_at[tile] = {side: at + latency[tile][side] for side in range(4)}

    def _listened(self, tile: int, side: int, arrival: Fraction) -> bool:
        """Whether the neighbour was on all the time that the message was on its line."""
        other, line = self.neighbours[tile][side], self.line[side]
        return other is None or line == 0 or self.on_since[other] <= arrival - line

    def _listed_step(self) -> None:
        # A tile that is not drawn is not silent: its last message still is its state.
        for tile in self.tiles:
            for other in self.neighbours[tile]:
                if self.on[tile] and self.received_at.get((tile, other)) == self.now - 1:  # type: ignore[arg-type]
                    self.received_at[tile, other] = self.now  # type: ignore[index]
        for tile in self.sending:
            self._send(tile)
        self.sending = []
        for _ in self.tiles:
            tile = (next(self.numbers) >> 32) * len(self.tiles) >> 32
            if self.on[tile]:
                self._update(tile)
                self._send(tile)

    def _half_step(self) -> None:
        for tile in self.tiles:
            # A tile that skips its turn still has the state of its last message: its receivers count as up to
            # date.
            if self.on[tile] and tile not in self.sending:
                for other in self.neighbours[tile]:
                    if other is not None and self.received_at.get((tile, other)) == self.now - Fraction(1, 2):
                        self.received_at[tile, other] = self.now
        for tile in self.sending:
            if self.on[tile]:
                self._send(tile)
        firing = []
        for tile in self.tiles:
            if tile % 64 == 0:
                bits = next(self.numbers)
            if bits >> tile % 64 & 1 and self.on[tile]:
                firing.append(tile)
                self._update(tile)
        self.sending = firing

    def _lost(self, lost: str) -> list[bool]:
        if self.setup.loss == 0 or (lost == "zero") != self.setup.zeros:
            return [False] * 4
        draws = [next(self.numbers), next(self.numbers)]
        return [
            (draws[side // 2] >> 32 * (side % 2)) % 2**32 < round(self.setup.loss * 2**32)
            for side in range(4)
        ]

    def _send(self, tile: int, sides: Sequence[int] = range(4)) -> None:
        for side, (other, lost) in enumerate(zip(self.neighbours[tile], self._lost("held"), strict=True)):
            if side not in sides:
                continue
            if other is not None and not lost:
                self.received[tile, other] = self.own[tile]
                self.received_at[tile, other] = self.now
            elif other is not None and self.received_at.get((tile, other)) == self.now:
                self.received_at[tile, other] -= 1  # what it has is no longer the last message

    def _update(self, tile: int) -> None:
        if self.stuck[tile]:
            return
        nothing = np.zeros_like(self.own[tile])
        seen = [self.own[tile]]
        for other, lost in zip(self.neighbours[tile], self._lost("zero"), strict=True):
            if other is None or lost or self._silent(other, tile):
                seen.append(nothing)
            else:
                seen.append(self.received.get((other, tile), nothing))
        self.states[tile] = self.update(self.states[tile], np.concatenate(seen))
        self.own[tile] = self.message(self.states[tile])
        self.shown[tile] = int(np.argmax(self.states[tile][-self.classes :]))

    def _silent(self, sender: int, receiver: int) -> bool:
        held = self.setup.loss > 0 and not self.setup.zeros
        tracked = self.setup.fault != "none" or len(self.setup.changes) > 0 or held
        return tracked and self.now - self.received_at.get((sender, receiver), NEVER) > SILENT_PERIODS
