"""The faults of an array, each at its time; see `fault_spec` for how they are written."""

import random
from bisect import insort
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from math import inf

from tilenca.base.errors import UsageError
from tilenca.base.sides import SIDES
from tilenca.emulator.array import Array, Link, LinkFault
from tilenca.emulator.fault_spec import LINK_KINDS, USUAL_V, FaultSpec

# One direction: the tile, counted from 0, and the side that it leaves.
End = tuple[int, int]


@dataclass(frozen=True)
class FaultsMoment:
    """The faults of an array at a moment: those that stand, and those that will fall due."""

    restarted_s: dict[int, float]
    cut: set[End]
    everywhere: dict[str, float]
    due: list[tuple[float, int, Callable[[], None]]]
    spoilt: dict[End, dict[str, float]]
    turned: set[int]
    skewed: dict[int, float]


@dataclass
class Faults:
    """The faults of one array: injects each at its time.

    Attributes:
        restarted_s: the time of the last reset or switch-on of each tile that had one.
        cut: the ends at which cables are cut now.
        everywhere: the LINK_KINDS that all cables have now.
        turned: the tiles that lie turned by 90 degrees now.
        skewed: by how much the clocks of tiles are too fast now, in ppm; others are as they were made.
    """

    array: Array
    links: list[Link]
    seed: int
    restarted_s: dict[int, float] = field(default_factory=dict)
    cut: set[End] = field(default_factory=set)
    everywhere: dict[str, float] = field(default_factory=dict)
    turned: set[int] = field(default_factory=set)
    skewed: dict[int, float] = field(default_factory=dict)
    _due: list[tuple[float, int, Callable[[], None]]] = field(default_factory=list)
    _spoilt: dict[End, dict[str, float]] = field(default_factory=dict)

    def save(self) -> FaultsMoment:
        """A copy of all that is planned and stands."""
        spoilt = {end: dict(kinds) for end, kinds in self._spoilt.items()}
        return FaultsMoment(
            dict(self.restarted_s),
            set(self.cut),
            dict(self.everywhere),
            list(self._due),
            spoilt,
            set(self.turned),
            dict(self.skewed),
        )

    def restore(self, moment: FaultsMoment) -> None:
        """Knows again what a copy says; the array's own snapshot has the faults themselves."""
        self.restarted_s, self.cut = dict(moment.restarted_s), set(moment.cut)
        self.everywhere, self._due = dict(moment.everywhere), list(moment.due)
        self._spoilt = {end: dict(kinds) for end, kinds in moment.spoilt.items()}
        self.turned, self.skewed = set(moment.turned), dict(moment.skewed)

    def add(self, spec: FaultSpec) -> None:
        """Plans a fault.

        Raises:
            UsageError: there is no such tile or cable.
        """
        if spec.kind in LINK_KINDS:
            ends = self._ends(spec)

            def set_to(value: float) -> None:
                if spec.where:
                    self.spoil(ends, spec.kind, value)
                else:
                    self.spoil_all(spec.kind, value)

            self._plan(spec.from_s, partial(set_to, spec.value))
            if spec.to_s is not None:
                self._plan(spec.to_s, partial(set_to, 0.0))
        elif spec.kind == "cut":
            self._plan_switch(spec, [partial(self.connect, end) for end in self._ends(spec)])
        elif spec.kind == "off":
            tiles = self._tiles(spec)
            self._plan_switch(spec, [partial(self.power, tile) for tile in tiles])
        elif spec.kind == "turn":
            self._plan_switch(spec, [partial(self.lay_straight, tile) for tile in self._tiles(spec)])
        else:
            for tile in self._tiles(spec):
                self._plan(spec.from_s, self._action(spec, tile))
                if spec.to_s is not None:
                    self._plan(spec.to_s, partial(self._end, spec.kind, tile))

    def _plan(self, time_s: float, action: Callable[[], None]) -> None:
        insort(self._due, (time_s, len(self._due), action), key=lambda due: due[:2])

    def _plan_switch(self, spec: FaultSpec, switches: list[Callable[[bool], None]]) -> None:
        for switch in switches:
            self._plan(spec.from_s, partial(switch, False))
            if spec.to_s is not None:
                self._plan(spec.to_s, partial(switch, True))

    def _action(self, spec: FaultSpec, tile: int) -> Callable[[], None]:
        if spec.kind == "reset":
            return lambda: self.reset(tile)
        if spec.kind == "remove":
            return lambda: self.array.remove_tile(tile)
        if spec.kind == "adc":
            return lambda: self.array[tile].set_adc_noise(spec.value, self.seed)
        if spec.kind == "supply":
            return lambda: self.array[tile].set_supply(spec.value)
        rate = spec.value
        if not spec.where:
            rate *= random.Random(f"{self.seed} {spec.kind} {tile}").uniform(-1, 1)
        if spec.kind == "skew":
            return partial(self.skew, tile, rate)
        return lambda: self.array[tile].set_drift(rate)

    def _end(self, kind: str, tile: int) -> None:
        """Ends a fault of TILE_KINDS that has an end."""
        if kind == "skew":
            self.skew(tile, 0.0)
        else:
            self.array[tile].set_supply(USUAL_V)

    def run(self, seconds: float) -> list[int]:
        """Runs the array for a while, and injects the faults that fall due.

        Returns:
            The tiles that have started anew meanwhile.

        Raises:
            TilencaError: a tile stopped at a fault of its program.
        """
        start_s = self.array.time_s
        end_s = start_s + seconds
        while self._due and self._due[0][0] <= end_s:
            time_s, _, action = self._due[0]
            if time_s > self.array.time_s:
                self.array.run(time_s - self.array.time_s)
                if self.array.halted:
                    break  # at a breakpoint, before that time
            del self._due[0]
            action()
        else:
            if end_s > self.array.time_s:
                self.array.run(end_s - self.array.time_s)
        return [tile for tile, time_s in self.restarted_s.items() if time_s >= start_s]

    @property
    def next_s(self) -> float:
        """The time of the next one that is planned."""
        return self._due[0][0] if self._due else inf

    # --- what they do ---

    def spoil(self, ends: list[End], kind: str, value: float) -> None:
        """Sets one of LINK_KINDS in the directions that leave these ends."""
        for end in ends:
            spoilt = self._spoilt.setdefault(end, {})
            spoilt[kind] = value
            fault = LinkFault(
                spoilt.get("loss", 0.0), spoilt.get("flip", 0.0), spoilt.get("delay", 0.0) / 1000
            )
            with suppress(UsageError):  # the cable has gone with its tile
                self.array.set_fault(*end, fault, self.seed)

    def spoil_all(self, kind: str, value: float) -> None:
        """Sets one of LINK_KINDS on all cables, and on those that come later."""
        self.everywhere[kind] = value
        self.spoil(sorted(end for link in self.links for end in (link[:2], link[2:])), kind, value)

    def plug_in(self, link: Link) -> None:
        """A new cable: it has the faults that all cables have now, and no other."""
        ends = [link[:2], link[2:]]
        for end in ends:
            self._spoilt.pop(end, None)
        for kind, value in self.everywhere.items():
            self.spoil(ends, kind, value)
        self._join(link)

    def connect(self, end: End, on: bool) -> None:
        """Cuts the cable at an end, or mends it."""
        for link in self.links:
            if end in (link[:2], link[2:]):
                (self.cut.discard if on else self.cut.add)(end)
                self._join(link)

    def lay_straight(self, tile: int, on: bool) -> None:
        """Lays a tile straight, or turns it by 90 degrees."""
        (self.turned.discard if on else self.turned.add)(tile)
        for link in self.links:
            if tile in (link[0], link[2]):
                self._join(link)

    def skew(self, tile: int, ppm: float) -> None:
        """From now on a tile's clock is so much faster than it was made; 0: as it was made."""
        self.array[tile].set_skew(ppm)
        self.skewed[tile] = ppm

    def _join(self, link: Link) -> None:
        """Lets a cable carry bytes, unless it is cut or one of its tiles is turned."""
        is_whole = self._is_whole(link)
        with suppress(UsageError):  # it has gone with its tile
            (self.array.mend if is_whole else self.array.cut)(*link[:2])

    def plug(self, tile: int, on: bool) -> None:
        """Takes a tile out, with its cables and its power, or plugs it in again."""
        for end in sorted(end for link in self.links for end in (link[:2], link[2:])):
            if end[0] == tile:
                self.connect(end, on)
        self.power(tile, on)

    def power(self, tile: int, on: bool) -> None:
        """Switches a tile on or off."""
        self.array[tile].powered = on
        if on:
            self.restarted_s[tile] = self.array.time_s

    def reset(self, tile: int) -> None:
        """Starts a tile's program anew, as its reset pin does."""
        self.array[tile].reset()
        self.restarted_s[tile] = self.array.time_s

    # --- where they do it ---

    def _tiles(self, spec: FaultSpec) -> list[int]:
        return [self._tile(spec, spec.where)] if spec.where else list(range(len(self.array)))

    def _tile(self, spec: FaultSpec, text: str) -> int:
        if not text.isdecimal() or not 1 <= int(text) <= len(self.array):
            raise spec.refuse(self.no_tile(text))
        return int(text) - 1

    def no_tile(self, text: str) -> str:
        """What is wrong with a tile that there is not."""
        return f"no tile '{text}'; they are 1 to {len(self.array)}, from left to right and top to bottom"

    def _ends(self, spec: FaultSpec) -> list[End]:
        both = [(a, side, b, other) for a, side, b, other in self.links]
        both += [(b, other, a, side) for a, side, b, other in self.links]
        one, dash, two = spec.where.partition("-")
        if not spec.where:
            ends = [link[:2] for link in both]
        elif dash:
            pair = {self._tile(spec, one), self._tile(spec, two)}
            ends = [(tile, side) for tile, side, other, _ in both if {tile, other} == pair]
        elif spec.where[-1:] in SIDES:
            wanted = (self._tile(spec, one[:-1]), SIDES.index(one[-1]))
            ends = [(tile, side) for tile, side, _, _ in both if (tile, side) == wanted]
        else:
            wanted_tile = self._tile(spec, one)
            ends = [(tile, side) for tile, side, other, _ in both if wanted_tile in (tile, other)]
        if not ends and spec.where:
            tile = self._tile(spec, one.rstrip("".join(SIDES)))
            there = sorted((side, other) for a, side, other, _ in both if a == tile)
            cables = ", ".join(f"{SIDES[side]} to tile {other + 1}" for side, other in there)
            raise spec.refuse(f"no cable there; tile {tile + 1} has {cables or 'none'}")
        return sorted(ends)

    def _is_whole(self, link: Link) -> bool:
        return self.cut.isdisjoint((link[:2], link[2:])) and self.turned.isdisjoint((link[0], link[2]))

    def parts(self) -> list[list[int]]:
        """The tiles with power, in parts that whole cables join, the largest first."""
        part = {tile.index: {tile.index} for tile in self.array if tile.powered}
        for link in self.links:
            if self._is_whole(link) and link[0] in part and link[2] in part:
                joined = part[link[0]] | part[link[2]]
                part.update(dict.fromkeys(joined, joined))
        return sorted({min(tiles): sorted(tiles) for tiles in part.values()}.values(), key=len, reverse=True)
