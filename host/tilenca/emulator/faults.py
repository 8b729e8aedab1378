"""`tilenca emulate --fault SPEC`: faults of tiles and cables, and their times.

KIND[=VALUE][@WHERE][:FROM[-TO]], times in seconds:

    loss=0.1            a tenth of the bytes on all cables is lost
    flip=0.001@3E       of the bits that leave tile 3 to the east, one in a thousand is inverted
    delay=5@3-4:2-3     the cable between tiles 3 and 4 takes 5 ms more, from 2 s to 3 s
    cut@3-4:2-3         that cable is cut at 2 s and mended at 3 s
    off@7:2-3           tile 7 has no power from 2 s to 3 s; without the end, it stays off
    remove@7:2          tile 7 is taken away at 2 s
    reset@7:2           tile 7 is reset at 2 s
    drift=20@7          tile 7's clock error grows by 20 ppm a second; without a tile, each by up to so much
    adc=2               conversions are off by 2, root mean square
    supply=4.3@7:2-3    tile 7 has 4.3 V from 2 s to 3 s, and 5 V otherwise
"""

import random
import re
from bisect import insort
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial

from tilenca.base.errors import UsageError
from tilenca.base.sides import SIDES
from tilenca.emulator.array import Array, Link, LinkFault

EXAMPLE = "loss=0.1@3E:2-5 or cut@3-4:2"
LINK_KINDS = {"loss": 1.0, "flip": 1.0, "delay": 1000.0}  # with the most each can be
TILE_KINDS = {"drift": 10_000.0, "adc": 100.0, "supply": 5.5}
LEAST_V, USUAL_V = 1.8, 5.0
MOMENT_KINDS = ("cut", "off", "remove", "reset")
KINDS = (*LINK_KINDS, *MOMENT_KINDS, *TILE_KINDS)
SHAPE = re.compile(r"([a-z]+)(?:=([^@:]+))?(?:@([^:]+))?(?::([^-]+)(?:-(.+))?)?")
# One direction: the tile, counted from 0, and the side that it leaves.
End = tuple[int, int]


@dataclass(frozen=True)
class FaultSpec:
    """One parsed `--fault`; see the module.

    Attributes:
        text: as it was given.
        kind: one of the words above.
        value: its number; 0 where it takes none.
        where: as given; "" for everywhere.
        from_s: when it begins.
        to_s: when it ends; None: never.
    """

    text: str
    kind: str
    value: float
    where: str
    from_s: float
    to_s: float | None

    def refuse(self, fact: str) -> UsageError:
        """The error for this one."""
        return _complaint(self.text, fact)


def _complaint(text: str, fact: str) -> UsageError:
    return UsageError(f"--fault '{text}': {fact}; for example {EXAMPLE}")


def _number(text: str, part: str, fact: str) -> float:
    try:
        value = float(part)
    except ValueError:
        value = -1.0
    if not 0 <= value < float("inf"):
        raise _complaint(text, f"'{part}' is no {fact}")
    return value


def parse(text: str) -> FaultSpec:
    """Parses a `--fault`.

    Raises:
        UsageError: it is not valid; the message says why.
    """
    match = SHAPE.fullmatch(text)
    kinds = (*LINK_KINDS, *MOMENT_KINDS, *TILE_KINDS)
    word = re.match("[a-z]*", text)
    if word is None or word[0] not in kinds:
        raise _complaint(text, f"it begins with none of {', '.join(kinds)}")
    if match is None:
        raise _complaint(text, f"after {word[0]} comes [=VALUE][@WHERE][:FROM[-TO]], times in seconds from 0")
    kind, value_text, where, from_text, to_text = match.groups()
    most = (LINK_KINDS | TILE_KINDS).get(kind)
    if (most is None) != (value_text is None):
        raise _complaint(text, f"{kind} takes {'no' if most is None else 'a'} number")
    value = 0.0 if value_text is None else _number(text, value_text, "number")
    if most is not None and value > most:
        raise _complaint(text, f"{kind} is 0 to {most:g}")
    if kind == "supply" and value < LEAST_V:
        raise _complaint(text, f"supply is {LEAST_V:g} to {most:g} V")
    from_s = 0.0 if from_text is None else _number(text, from_text, "time in seconds")
    to_s = None if to_text is None else _number(text, to_text, "time in seconds")
    if to_s is not None and (to_s <= from_s or kind in ("remove", "reset", "adc", "drift")):
        raise _complaint(text, "it ends before it begins" if to_s <= from_s else f"{kind} has no end")
    if kind in MOMENT_KINDS and where is None:
        raise _complaint(text, f"{kind} needs a place")
    return FaultSpec(text, kind, value, where or "", from_s, to_s)


@dataclass(frozen=True)
class FaultsMoment:
    """The faults of an array at a moment: those that stand, and those that will fall due."""

    restarted_s: dict[int, float]
    cut: set[End]
    everywhere: dict[str, float]
    due: list[tuple[float, int, Callable[[], None]]]
    spoilt: dict[End, dict[str, float]]


@dataclass
class Faults:
    """The faults of one array: injects each at its time.

    Attributes:
        restarted_s: the time of the last reset or switch-on of each tile that had one.
        cut: the ends at which cables are cut now.
        everywhere: the LINK_KINDS that all cables have now.
    """

    array: Array
    links: list[Link]
    seed: int
    restarted_s: dict[int, float] = field(default_factory=dict)
    cut: set[End] = field(default_factory=set)
    everywhere: dict[str, float] = field(default_factory=dict)
    _due: list[tuple[float, int, Callable[[], None]]] = field(default_factory=list)
    _spoilt: dict[End, dict[str, float]] = field(default_factory=dict)

    def save(self) -> FaultsMoment:
        """A copy of all that is planned and stands."""
        spoilt = {end: dict(kinds) for end, kinds in self._spoilt.items()}
        return FaultsMoment(
            dict(self.restarted_s), set(self.cut), dict(self.everywhere), list(self._due), spoilt
        )

    def restore(self, moment: FaultsMoment) -> None:
        """Knows again what a copy says; the array's own snapshot has the faults themselves."""
        self.restarted_s, self.cut = dict(moment.restarted_s), set(moment.cut)
        self.everywhere, self._due = dict(moment.everywhere), list(moment.due)
        self._spoilt = {end: dict(kinds) for end, kinds in moment.spoilt.items()}

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
            self._plan_switch(spec, [partial(self._power, tile) for tile in tiles])
        else:
            for tile in self._tiles(spec):
                self._plan(spec.from_s, self._action(spec, tile))
                if spec.to_s is not None:  # of these, only a supply has an end
                    self._plan(spec.to_s, partial(self.array[tile].set_supply, USUAL_V))

    def _plan(self, time_s: float, action: Callable[[], None]) -> None:
        insort(self._due, (time_s, len(self._due), action), key=lambda due: due[:2])

    def _plan_switch(self, spec: FaultSpec, switches: list[Callable[[bool], None]]) -> None:
        for switch in switches:
            self._plan(spec.from_s, partial(switch, False))
            if spec.to_s is not None:
                self._plan(spec.to_s, partial(switch, True))

    def _action(self, spec: FaultSpec, tile: int) -> Callable[[], None]:
        def reset() -> None:
            self.array[tile].reset()
            self.restarted_s[tile] = self.array.time_s

        if spec.kind == "reset":
            return reset
        if spec.kind == "remove":
            return lambda: self.array.remove_tile(tile)
        if spec.kind == "adc":
            return lambda: self.array[tile].set_adc_noise(spec.value, self.seed)
        if spec.kind == "supply":
            return lambda: self.array[tile].set_supply(spec.value)
        rate = spec.value
        if not spec.where:
            rate *= random.Random(f"{self.seed} drift {tile}").uniform(-1, 1)
        return lambda: self.array[tile].set_drift(rate)

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
            time_s, _, action = self._due.pop(0)
            if time_s > self.array.time_s:
                self.array.run(time_s - self.array.time_s)
            action()
        if end_s > self.array.time_s:
            self.array.run(end_s - self.array.time_s)
        return [tile for tile, time_s in self.restarted_s.items() if time_s >= start_s]

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

    def connect(self, end: End, on: bool) -> None:
        """Cuts the cable at an end, or mends it."""
        with suppress(UsageError):  # the cable has gone with its tile
            (self.array.mend if on else self.array.cut)(*end)
            (self.cut.discard if on else self.cut.add)(end)

    def plug(self, tile: int, on: bool) -> None:
        """Takes a tile out, with its cables and its power, or plugs it in again."""
        for end in sorted(end for link in self.links for end in (link[:2], link[2:])):
            if end[0] == tile:
                self.connect(end, on)
        self._power(tile, on)

    def _power(self, tile: int, on: bool) -> None:
        self.array[tile].powered = on
        if on:
            self.restarted_s[tile] = self.array.time_s

    # --- where they do it ---

    def _tiles(self, spec: FaultSpec) -> list[int]:
        return [self._tile(spec, spec.where)] if spec.where else list(range(len(self.array)))

    def _tile(self, spec: FaultSpec, text: str) -> int:
        if not text.isdecimal() or not 1 <= int(text) <= len(self.array):
            raise spec.refuse(f"no tile '{text}'; they are 1 to {len(self.array)}")
        return int(text) - 1

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
            raise spec.refuse("no cable there")
        return sorted(ends)
