"""`tilenca emulate --fault SPEC`: boards that are faulty, beside the faults of `tilenca.emulator.faults`.

KIND=VALUE@TILE[:FROM[-TO]], times in seconds; plug takes no value:

    high=PE3@7          the pin has a short to the supply; low=PE3@7: to ground
    joined=PH4+PH3@7    a bridge of solder: the second pin follows the first one
    led=3@7             link LED 3 is missing
    plug@7E             a loop-back plug on the east side, which must have no cable
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

from tilenca.base.errors import UsageError
from tilenca.base.sides import SIDES
from tilenca.base.suggest import did_you_mean
from tilenca.emulator.array import Array
from tilenca.emulator.fault_spec import EXAMPLE, KINDS, FaultError, FaultSpec
from tilenca.emulator.fault_spec import parse as parse_fault
from tilenca.emulator.faults import Faults
from tilenca.emulator.library import call, new
from tilenca.emulator.tile import EmulatedTile

PIN = r"P([A-L])([0-7])"
VALUES = {
    "high": (PIN, "a pin, such as PE3"),
    "low": (PIN, "a pin, such as PE3"),
    "joined": (rf"{PIN}\+{PIN}", "two pins, such as PH4+PH3"),
    "led": (r"([1-4])", "a link LED, 1 to 4"),
    "plug": ("", "no value"),
}
EXAMPLES = {
    "high": "high=PE3@7",
    "low": "low=PE3@7:2-3",
    "joined": "joined=PH4+PH3@7",
    "led": "led=3@7",
    "plug": "plug@1N",
}
PIN_KINDS = ("high", "low", "joined")
ALL_KINDS = (*KINDS, *VALUES)
SHAPE = re.compile(r"([a-z]+)(?:=([^@:]+))?@(\d+)([NESW]?)(?::(\d+(?:\.\d+)?)(?:-(\d+(?:\.\d+)?))?)?")
FIRST_LED_CHANNEL, OPEN, USUAL = 8, 1023, 512  # what the ADC says of an LED that is missing, and of one
STEP_S, LEAST_S = 0.001, 1e-6  # bridges and plugs are looked at so often; an array runs no shorter
PLUG_DELAY_S = 0.005  # what a plug hands back comes this much later
CLOCK_HZ = 16e6


@dataclass(frozen=True)
class BoardFault:
    """One parsed fault of a board; see the module.

    Attributes:
        text: as it was given.
        kind: one of the words above.
        values: the parts of its value.
        tile: counted from 1.
        side: of a plug.
        from_s: when it begins.
        to_s: when it ends; None: never.
    """

    text: str
    kind: str
    values: tuple[str, ...]
    tile: int
    side: str
    from_s: float
    to_s: float | None

    def refuse(self, fact: str) -> FaultError:
        """The error for this one."""
        return FaultError(f"--fault '{self.text}': {fact}; for example {EXAMPLES[self.kind]}")


def parse(text: str) -> FaultSpec | BoardFault:
    """Parses a `--fault` of either kind.

    Raises:
        UsageError: it is not valid; the message says why.
    """
    word = re.match("[a-z]*", text)
    kind = word[0] if word else ""
    if kind in KINDS:
        return parse_fault(text)
    if kind not in VALUES:
        meant = did_you_mean(kind, ALL_KINDS)
        raise UsageError(
            f"--fault '{text}': it begins with none of {', '.join(ALL_KINDS)}{meant}; for example {EXAMPLE}"
        )
    pattern, wanted = VALUES[kind]
    match = SHAPE.fullmatch(text)
    value = match and re.fullmatch(pattern, match[2] or "")
    if match is None or value is None or (kind == "plug") != bool(match[4]):
        place = "@TILE and a side" if kind == "plug" else "@TILE"
        raise UsageError(
            f"--fault '{text}': {kind} takes {wanted}, then {place}, then [:FROM[-TO]] in seconds; "
            f"for example {EXAMPLES[kind]}"
        )
    from_s, to_s = float(match[5] or 0), float(match[6]) if match[6] else None
    fault = BoardFault(text, kind, value.groups(), int(match[3]), match[4], from_s, to_s)
    if to_s is not None and to_s <= from_s:
        raise fault.refuse("it ends before it begins")
    return fault


@dataclass
class BoardFaults(Faults):
    """The faults of an array, those of boards among them."""

    # What has to be done every millisecond.
    _going: dict[BoardFault, Callable[[], None]] = field(default_factory=dict)

    def add(self, spec: FaultSpec | BoardFault) -> None:
        """Plans a fault.

        Raises:
            UsageError: there is no such tile or cable, or there is a cable where a plug should go.
        """
        if isinstance(spec, BoardFault):
            self._add_board(spec)
        else:
            super().add(spec)

    def _add_board(self, fault: BoardFault) -> None:
        if not 1 <= fault.tile <= len(self.array):
            raise fault.refuse(self.no_tile(str(fault.tile)))
        if fault.kind in PIN_KINDS:
            self._check_pins(fault)
        if fault.kind == "plug":
            end = (fault.tile - 1, SIDES.index(fault.side))
            if any(end in (link[:2], link[2:]) for link in self.links):
                raise fault.refuse("there is a cable; a plug goes on a side without a neighbour")
        self._plan(fault.from_s, partial(self._begin_board, fault))
        if fault.to_s is not None:
            self._plan(fault.to_s, partial(self._end_board, fault))

    def _check_pins(self, fault: BoardFault) -> None:
        """Refuses a pin that the chip has not."""
        for port, bit in zip(fault.values[::2], fault.values[1::2], strict=True):
            try:
                self.array[fault.tile - 1].pin(port, int(bit))
            except UsageError as error:
                raise fault.refuse(str(error)) from error

    def run(self, seconds: float) -> list[int]:
        """As that of `Faults`, and does what bridges and plugs do meanwhile."""
        restarted: set[int] = set()
        end_s = self.array.time_s + seconds
        while (left_s := end_s - (now_s := self.array.time_s)) > LEAST_S:
            planned = len(self._due)
            restarted |= set(super().run(self._step_s(left_s)))
            for act in list(self._going.values()):
                act()
            if self.array.time_s == now_s and len(self._due) == planned:
                break  # a tile is halted: whoever halted it goes on
        return sorted(restarted)

    def _step_s(self, left_s: float) -> float:
        """How far to run at once: to what begins next, and while anything is going not far."""
        if self._going:
            return min(STEP_S, left_s)
        due_s = self._due[0][0] - self.array.time_s if self._due else left_s
        return min(max(due_s, LEAST_S), left_s)

    def _begin_board(self, fault: BoardFault) -> None:
        tile = self.array[fault.tile - 1]
        match fault.kind, fault.values:
            case "high" | "low" as level, (port, bit):
                tile.hold_pin(port, int(bit), level == "high")
            case "joined", (one, one_bit, other, other_bit):
                self._going[fault] = lambda: tile.hold_pin(other, int(other_bit), tile.pin(one, int(one_bit)))
            case "led", (number,):
                tile.set_analog(FIRST_LED_CHANNEL + int(number) - 1, OPEN)
            case _:
                self._going[fault] = Plug(self.array, tile, SIDES.index(fault.side)).play

    def _end_board(self, fault: BoardFault) -> None:
        tile = self.array[fault.tile - 1]
        self._going.pop(fault, None)
        match fault.kind, fault.values:
            case ("high" | "low", (port, bit)) | ("joined", (_, _, port, bit)):
                tile.hold_pin(port, int(bit), None)
            case "led", (number,):
                tile.set_analog(FIRST_LED_CHANNEL + int(number) - 1, USUAL)
            case _:
                tile.hold_pin(*tile.side_pin(SIDES.index(fault.side), receiving=True), None)


class Plug:
    """A loop-back plug: what leaves a side comes in there again, a little later. Play it every few ms."""

    def __init__(self, array: Array, tile: EmulatedTile, side: int) -> None:
        """Puts it on a side of a tile."""
        self._array, self._tile = array, tile
        self._pin = tile.side_pin(side, receiving=True)
        self._probe = tile.probe(*tile.side_pin(side))
        self._before = self._now()

    def play(self) -> None:
        """Hands back the edges that have left since the last call."""
        begin_s, begin = self._before
        self._before = end_s, end = self._now()
        for edge in self._probe.read():  # by the tile's own clock, which is off
            gone = (edge.time_s - begin_s) / (end_s - begin_s) if end_s > begin_s else 1.0
            cycle = begin + gone * (end - begin) + PLUG_DELAY_S * CLOCK_HZ
            self._tile.push_edge(*self._pin, round(cycle), edge.level)

    def _now(self) -> tuple[float, int]:
        """The array's time, and the tile's cycle."""
        cycles = new("tilenca_cycles*")
        call("tile_cycles", self._array.handle, self._tile.index, cycles)
        return self._array.time_s, cycles.total
