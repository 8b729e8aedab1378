"""How far clocks and edges may be off before links lose frames: bench.margins [--write FILE | --check].

Two emulated tiles run the real firmware. In the tables of edges a program carries each edge from pin to pin,
and moves it on the way.
"""

import argparse
import random
import sys
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from bench.publish import publish, stands
from tilenca.base import paths
from tilenca.base.processors import processors
from tilenca.base.sides import EAST, NORTH, SIDES, SOUTH, WEST
from tilenca.emulator import Array
from tilenca.emulator.tile import EmulatedTile
from tilenca.protocol.constants import DEFAULT_PERIOD_MS, LINK_BAUD, ROW_BAUD
from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.sentences import LinkSentence
from tilenca.protocol.settings import settings_block

BEGIN, END = "<!-- margins: made by `python -m bench.margins`, do not edit -->", "<!-- /margins -->"
PAGE = paths.ROOT / "docs" / "HARDWARE.md"
CLOCK_HZ = 16e6
START_S, SECONDS = 2.0, 10.0
STEP_S, CARRIED_S = 0.002, 0.006
DIFFERENCES = (0.0, 1.0, 1.6, 2.0, 2.4, 2.8, 3.2, 3.6, 4.0, 4.4)  # percent; above, no USB reads them
PARTS = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3)  # of a bit
USUAL = 1.0  # percent: two resonators of 0.5 % each
# The reports of two tiles are not of the same moment: of what one has sent, the other knows of so much.
MOST = 0.85
# The links of two tiles that surround each other.
UNDER_TEST = ((0, SOUTH, 1, NORTH), (0, EAST, 1, WEST))
REST = ((0, NORTH, 1, SOUTH), (0, WEST, 1, EAST))


@dataclass(frozen=True)
class Distortion:
    """What happens to edges, in bits: `jitter` to and fro at most, `rise` and `fall` so much later."""

    jitter: float = 0.0
    rise: float = 0.0
    fall: float = 0.0


@dataclass(frozen=True)
class Case:
    """One run.

    Attributes:
        difference: by how many percent tile 0 is faster than tile 1.
        busy: whether the other two sides of both tiles are joined, too.
        distortion: of the links under test; None: they are cables.
    """

    difference: float
    busy: bool
    distortion: Distortion | None = None
    seconds: float = SECONDS


@dataclass(frozen=True)
class Count:
    """Frames of one direction."""

    lost: int = 0
    arrived: int = 0

    def __add__(self, other: "Count") -> "Count":
        return Count(self.lost + other.lost, self.arrived + other.arrived)

    def __str__(self) -> str:
        return f"{self.lost:,} of {self.lost + self.arrived:,}"


@dataclass(frozen=True)
class Losses:
    """Frames of the three kinds of receivers."""

    by_usart: Count = Count()  # from the software UART
    by_software: Count = Count()  # from a USART
    in_rows: Count = Count()  # between USARTs, at the higher rate

    def __add__(self, other: "Losses") -> "Losses":
        return Losses(
            self.by_usart + other.by_usart,
            self.by_software + other.by_software,
            self.in_rows + other.in_rows,
        )

    @property
    def counts(self) -> tuple[Count, Count, Count]:
        """In the order of the columns."""
        return self.by_usart, self.by_software, self.in_rows


class Carrier:
    """Carries the edges of one pin to another tile's pin, a little later, and moves them on the way."""

    def __init__(self, sender: EmulatedTile, side: int, receiver: EmulatedTile, to: int, rate: float) -> None:
        self._probe = sender.probe(*sender.side_pin(side))
        self._receiver, self._pin = receiver, receiver.side_pin(to, receiving=True)
        self._cycles_per_s = rate
        self._bit_s = 1 / (ROW_BAUD if side in (EAST, WEST) else LINK_BAUD)
        self._last = 0

    def carry(self, distortion: Distortion, draw: random.Random) -> None:
        """Hands over what has left since the last call."""
        for edge in self._probe.read():
            late = (distortion.rise if edge.level else distortion.fall) * self._bit_s
            late += draw.uniform(-distortion.jitter, distortion.jitter) * self._bit_s
            cycle = max(round((edge.time_s + CARRIED_S + late) * self._cycles_per_s), self._last + 1)
            self._last = cycle
            self._receiver.push_edge(*self._pin, cycle, edge.level)


def run(case: Case) -> Losses:
    """Runs two tiles."""
    ppm = (5000 * case.difference, -5000 * case.difference)
    links = [*(UNDER_TEST if case.distortion is None else ()), *(REST if case.busy else ())]
    with Array(paths.FIRMWARE_ELF, 2, links, ppm, (0.0, 0.0137)) as array:
        for tile in array:
            tile.write_eeprom(0, settings_block(tile.index + 1, DEFAULT_PERIOD_MS, 0))
        carriers = []
        if case.distortion is not None:
            for one, side, other, facing in UNDER_TEST:
                ends = ((one, side, other, facing), (other, facing, one, side))
                carriers += [
                    Carrier(array[a], s, array[b], f, CLOCK_HZ * (1 + ppm[b] * 1e-6)) for a, s, b, f in ends
                ]
        draw = random.Random(f"{case}")
        readers = [LineReader() for _ in array]
        first: dict[tuple[int, str], LinkSentence] = {}
        last: dict[tuple[int, str], LinkSentence] = {}
        while array.time_s < START_S + case.seconds:
            for carrier in carriers:
                carrier.carry(case.distortion or Distortion(), draw)
            array.run(STEP_S if carriers else 0.5)
            for tile, reader in zip(array, readers, strict=True):
                for _, said in reader.feed(tile.read_serial()):
                    if isinstance(said, LinkSentence) and said.uptime_ms >= 1000 * START_S:
                        first.setdefault((tile.index, said.side), said)
                        last[tile.index, said.side] = said

    def moved(tile: int, side: int, counter: str) -> int:
        begin, end = (getattr(reports[tile, SIDES[side]], counter) for reports in (first, last))
        return int(end - begin)

    def count(tile: int, side: int, other: int, facing: int) -> Count:
        lost, arrived = moved(tile, side, "lost"), moved(tile, side, "received")
        times_ms = moved(tile, side, "uptime_ms"), moved(other, facing, "uptime_ms")
        sent = round(moved(other, facing, "sent") * times_ms[0] / times_ms[1])
        # Sequence numbers know nothing of a link that is silent.
        return Count(lost if lost + arrived > MOST * sent else sent - arrived, arrived)

    return Losses(
        count(1, NORTH, 0, SOUTH),
        count(0, SOUTH, 1, NORTH),
        count(1, WEST, 0, EAST) + count(0, EAST, 1, WEST),
    )


def both_signs(difference: float, **options: object) -> list[Case]:
    """Tile 0 faster, and slower."""
    signs = (1, -1) if difference else (1,)
    return [Case(sign * difference, **options) for sign in signs]  # type: ignore[arg-type]


def measure(groups: Sequence[list[Case]]) -> list[Losses]:
    """The losses of each group of cases, added up."""
    cases = [case for group in groups for case in group]
    with ProcessPoolExecutor(processors()) as pool:
        found = iter(list(pool.map(run, cases)))
    return [sum((next(found) for _ in group), Losses()) for group in groups]


def margin(rows: Iterable[tuple[float, Count]]) -> str:
    """Up to where nothing was lost."""
    well = 0.0
    for value, count in rows:
        if count.lost or not count.arrived:
            break
        well = value
    return f"{well:g}"


HEADER = "| {} | software UART to USART, 38,400 | USART to software UART, 38,400 | between USARTs, 125,000 |"


def clock_table(seconds: float) -> list[str]:
    """Frames lost against the clocks' difference."""
    lines = [HEADER.format("clocks differ by"), "|---|---|---|---|"]
    margins = []
    for busy in (False, True):
        groups = [both_signs(difference, busy=busy, seconds=seconds) for difference in DIFFERENCES]
        found = measure(groups)
        where = "all four sides busy" if busy else "these sides only"
        for difference, losses in zip(DIFFERENCES, found, strict=True):
            lines.append(f"| {difference:g} %, {where} | {' | '.join(map(str, losses.counts))} |")
        columns = zip(*(losses.counts for losses in found), strict=True)
        margins = [margin(zip(DIFFERENCES, column, strict=True)) for column in columns]
    by_usart, by_software, in_rows = margins
    return [
        *lines,
        "",
        f"With all sides busy nothing was lost up to {by_usart} % into a USART, {by_software} % into the "
        f"software UART, and {in_rows} % between USARTs.",
    ]


def edge_table(seconds: float) -> list[str]:
    """Frames lost against what happens to edges, with clocks that differ as usual."""
    lines = [HEADER.format("edges"), "|---|---|---|---|"]
    kinds = {
        "jitter of +-{}": [Distortion(jitter=part) for part in PARTS],
        "rising {} late": [Distortion(rise=part) for part in PARTS],
        "falling {} late": [Distortion(fall=part) for part in PARTS],
    }
    for name, distortions in kinds.items():
        groups = [both_signs(USUAL, busy=True, distortion=one, seconds=seconds) for one in distortions]
        for part, losses in zip(PARTS, measure(groups), strict=True):
            lines.append(f"| {name.format(f'{part:.0%} of a bit')} | {' | '.join(map(str, losses.counts))} |")
    return [*lines, "", f"Clocks differ by {USUAL:g} %, either tile the faster one; all four sides busy."]


def main() -> int:
    """Prints the tables, and writes them if asked to."""
    parser = argparse.ArgumentParser(description="How far clocks and edges may be off.")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--write", type=Path, metavar="F", help="put the tables into this document")
    what.add_argument("--check", action="store_true", help=f"write nothing, exit 1 where {PAGE} differs")
    parser.add_argument("--seconds", type=float, default=SECONDS, help="of each run (default: %(default)s)")
    args = parser.parse_args()
    about = (
        "Frames lost of those sent. Two tiles that surround each other, "
        f"an update every {DEFAULT_PERIOD_MS} ms, {args.seconds:g} s for each sign of the difference "
        f"(edges: {args.seconds / 2:g} s). "
        "A bit takes 26 us between south and north, and 8 us in rows."
    )
    section = "\n".join([about, "", *clock_table(args.seconds), "", *edge_table(args.seconds / 2)])
    publish(section, args.write, BEGIN, END)
    return 0 if not args.check or stands(section, PAGE, BEGIN, END) else 1


if __name__ == "__main__":
    sys.exit(main())
