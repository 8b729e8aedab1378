"""A profile of a tile's cycles: sampled on the emulated chip, and sorted by source file.

An image with line numbers is built beside the real one, and is the same to the byte. Interrupts are measured
one by one, from their entry to the end of their return.
"""

import re
import subprocess
import sys
from collections import Counter, defaultdict
from dataclasses import dataclass
from pathlib import Path

from firmware import cost_fit
from tilenca.base import paths
from tilenca.base.sides import SIDES
from tilenca.emulator import Array
from tilenca.emulator.wiring import cables
from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.sentences import TimeSentence
from tilenca.protocol.settings import settings_block
from tilenca.shapes.file import Shape

CROSS = Shape("X", (".#.", "###", ".#."), "X")
MIDDLE = 2
PPM = (900.0, -900.0, 333.0, 500.0, -500.0)
START_S = 1.0
LEAST_SAID_S = 2.5  # a tile tells its times every second
SAMPLE_S = 16e-6  # the shortest time an array runs
FOLDER = paths.BUILD / "account"
EXTRA_SCRIPT = paths.ROOT / "tools" / "firmware" / "debug_info.py"

# Cycles before an interrupt's first instruction: its entry and the jump there. And those of its return.
ENTRY, RETURN = 5 + 3, 5
CLOCK_HZ = 16e6
VECTORS, VECTOR_BYTES = 57, 4
INSTRUCTION = 2  # bytes of a short one

INTERRUPTS = {
    11: "south: an edge is stamped", 20: "south: a bit leaves",
    25: "USB: a byte comes", 26: "USB: a byte leaves",
    36: "east: a byte comes", 37: "east: a byte leaves",
    42: "the millisecond", 45: "the millisecond",
    51: "north: a byte comes",
    52: "north: a byte leaves", 54: "west: a byte comes", 55: "west: a byte leaves",
}  # fmt: skip

# The functions of firmware/src/avr/kernel.S.
KERNEL = ("tilenca_blocks", "tilenca_sum")

NETWORK, LOOP = "the network", "main loop, display, button, clock"
# The purpose of each source file's instructions; all other code is the main loop.
PARTS = {
    NETWORK: ("arithmetic", "network", "cell", "flash", "layer", "layers", "model"),
    "frames: COBS, CRC, counters": ("frame", "link", "crc16"),
    "links: queues": ("usart", "ring", "links"),
    "south: edges to bytes, bytes to toggles": ("south_uart", "edge_receiver", "toggles"),
    "telemetry, commands, timing": (
        "telemetry",
        "sentence",
        "command",
        "host",
        "settings",
        "settings_store",
        "timing",
        "boot",
    ),
}
ASLEEP, INTERRUPTED = "asleep", "interrupts"


@dataclass(frozen=True)
class Interrupt:
    """The duration of one interrupt, in cycles, and its rate."""

    name: str
    per_s: float
    mean: float
    longest: int

    @property
    def share(self) -> float:
        """Part of all time."""
        return self.per_s * self.mean / CLOCK_HZ


@dataclass(frozen=True)
class Account:
    """The use of a second of a tile's time.

    Attributes:
        period_ms: of the updates.
        shares: part of the time by its purpose, adding up to 1.
        neighbours: part of the time that receiving from a neighbour takes, by its side.
        worst_ms: the longest computation of an update, and the longest turn of the main loop, by name.
        interrupts: each of those that came.
    """

    period_ms: int
    shares: dict[str, float]
    neighbours: dict[str, float]
    worst_ms: dict[str, float]
    interrupts: list[Interrupt]


def build() -> Path:
    """The firmware with line numbers.

    Raises:
        CalledProcessError: it does not build.
    """
    pio = str(Path(sys.executable).with_name("pio"))
    command = [pio, "run", "-s", "-d", str(paths.ROOT), "-e", paths.FIRMWARE_ENV]
    environment = cost_fit.environment(BUILD_DIR=FOLDER, EXTRA_SCRIPTS=EXTRA_SCRIPT)
    subprocess.run(command, env=environment, check=True)
    return FOLDER / paths.FIRMWARE_ENV / "firmware.elf"


def running(elf: Path, period_ms: int) -> Array:
    """Five tiles in a cross, after their start; the one in the middle has four neighbours."""
    array = Array(elf, len(CROSS.cells), cables(CROSS), PPM)
    for tile in array:
        tile.write_eeprom(0, settings_block(tile.index + 1, period_ms, 0))
    array.run(START_S)
    return array


def interrupts(elf: Path, period_ms: int, seconds: float) -> list[Interrupt]:
    """Measures all interrupts of the tile in the middle."""
    vectors, returns = _handlers(elf)
    spent: dict[int, list[int]] = defaultdict(list)
    with running(elf, period_ms) as array:
        tile = array[MIDDLE]
        for address in (*vectors, *returns):
            tile.mark(address)
        end_s, began = array.time_s + seconds, (0, 0)
        while array.time_s < end_s:
            array.run(0.02)
            for mark in tile.marks():
                if mark.address in vectors:
                    began = vectors[mark.address], mark.cycle
                elif began[0]:
                    spent[began[0]].append(ENTRY + mark.cycle - began[1] + RETURN)
                    began = 0, 0
    return [
        Interrupt(
            INTERRUPTS.get(vector, f"vector {vector}"),
            len(times) / seconds,
            sum(times) / len(times),
            max(times),
        )
        for vector, times in sorted(spent.items())
    ]


def _listing(elf: Path) -> str:
    return subprocess.run(["avr-objdump", "-d", str(elf)], capture_output=True, check=True, text=True).stdout


def _instructions(elf: Path) -> list[tuple[str, int]]:
    """The name and the address of each."""
    found = re.findall(r"^\s*(\w+):\t[^\t]*\t(\w+)", _listing(elf), re.MULTILINE)
    return [(name, int(address, 16)) for address, name in found]


def _handlers(elf: Path) -> tuple[dict[int, int], set[int]]:
    """Address and vector number of each interrupt's first instruction, and the addresses of all returns."""
    starts = re.findall(r"^(\w+) <__vector_(\d+)>:", _listing(elf), re.MULTILINE)
    returns = {address for name, address in _instructions(elf) if name == "reti"}
    return {int(address, 16): int(number) for address, number in starts}, returns


def part_of(function: str, place: str) -> str:
    """The purpose of an instruction, by its function and `file:line`."""
    if function.startswith("__vector"):
        return INTERRUPTED
    if function in KERNEL:
        return NETWORK  # assembly has no line numbers, so objdump assigns it to the file before it
    stem = Path(place.rsplit(":", 1)[0]).stem
    for part, stems in PARTS.items():
        if stem in stems:
            return part
    return LOOP


def shares(elf: Path, period_ms: int, seconds: float) -> dict[str, float]:
    """Samples the tile in the middle; sleep is counted, not sampled."""
    beds = {at for name, at in _instructions(elf) if name == "sleep"}
    seen: Counter[int] = Counter()
    with running(elf, period_ms) as array:
        tile = array[MIDDLE]
        before, slept_before = tile.cycles
        end_s = array.time_s + seconds
        while array.time_s < end_s:
            array.run(SAMPLE_S)
            seen[tile.pc] += 1
        after, slept_after = tile.cycles
        functions = {address: array.function_at(address) for address in seen}
    asleep = (slept_after - slept_before) / (after - before)
    awake = {address: count for address, count in seen.items() if address - INSTRUCTION not in beds}
    command = ["avr-addr2line", "-e", str(elf), *map(hex, awake)]
    places = subprocess.run(command, capture_output=True, check=True, text=True).stdout.splitlines()
    found: Counter[str] = Counter()
    for (address, count), place in zip(awake.items(), places, strict=True):
        vector = address < VECTORS * VECTOR_BYTES
        found[INTERRUPTED if vector else part_of(functions[address], place)] += count
    total = sum(found.values())
    return {ASLEEP: asleep} | {part: (1 - asleep) * count / total for part, count in found.most_common()}


def neighbours(elf: Path, period_ms: int, seconds: float) -> dict[str, float]:
    """The share of its time that a tile spends on receiving from a neighbour, by the side."""
    awake = {}
    for links in ([], *([(0, side, 1, (side + 2) % len(SIDES))] for side in range(len(SIDES)))):
        with Array(elf, 2, links, PPM[:2]) as array:
            for tile in array:
                tile.write_eeprom(0, settings_block(tile.index + 1, period_ms, 0))
            array.run(START_S)
            before, slept_before = array[0].cycles
            array.run(seconds)
            after, slept_after = array[0].cycles
        awake[SIDES[links[0][1]] if links else ""] = 1 - (slept_after - slept_before) / (after - before)
    alone = awake.pop("")
    return {side: share - alone for side, share in awake.items()}


def worst(elf: Path, period_ms: int, seconds: float) -> dict[str, float]:
    """The longest times that the tile in the middle reports."""
    reader = LineReader()
    with running(elf, period_ms) as array:
        reader.feed(array[MIDDLE].read_serial())
        array.run(max(seconds, LEAST_SAID_S))
        said = [sentence for _, sentence in reader.feed(array[MIDDLE].read_serial())]
    times = [sentence for sentence in said if isinstance(sentence, TimeSentence)]
    return {
        "longest computation of an update": max(time.compute_us for time in times) / 1000,
        "longest turn of the main loop, sleep included": max(time.gap_us for time in times) / 1000,
    }


def account(period_ms: int, seconds: float) -> Account:
    """Builds, runs and measures.

    Raises:
        CalledProcessError, TilencaError: the firmware cannot be built or run.
    """
    elf = build()
    return Account(
        period_ms,
        shares(elf, period_ms, seconds),
        neighbours(elf, period_ms, seconds),
        worst(elf, period_ms, seconds),
        interrupts(elf, period_ms, seconds),
    )
