"""The links' losses and a tile's use of time: python -m bench.links FIRMWARE.elf [--write FILE].

Everything is counted on emulated chips, so that the figures are the same on every machine.
"""

import argparse
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from bench import soak
from bench.figures import exact, note
from bench.publish import publish
from firmware import cost_fit, profile
from tilenca.base import paths
from tilenca.base.sides import NORTH, SOUTH
from tilenca.emulator import Array
from tilenca.emulator.greeting import firmware_settings

BEGIN, END = "<!-- links: made by `make bench`, do not edit -->", "<!-- /links -->"
SOFTWARE_ENV = "software_serial"
PERIODS_MS = (0, 10, 20, 100)  # 0: as fast as they go
PAIR_PPM = (5000.0, -5000.0)
PAIR_START_S = (0.0, 0.0137)
DATA_SPACE = 0x800000


@dataclass(frozen=True)
class Pair:
    """Two boards, one above the other, whose sides are SoftwareSerial and Serial2.

    Attributes:
        from_software: frames sent and received, upper board to lower one.
        to_software: the same the other way.
    """

    period_ms: int
    from_software: tuple[int, int]
    to_software: tuple[int, int]


def software_serial() -> Path:
    """The image with Arduino's SoftwareSerial.

    Raises:
        CalledProcessError: it does not build.
    """
    pio = str(Path(sys.executable).with_name("pio"))
    folder = paths.BUILD / SOFTWARE_ENV
    command = [pio, "run", "-s", "-d", str(paths.ROOT), "-e", SOFTWARE_ENV]
    environment = cost_fit.environment(BUILD_DIR=folder)
    subprocess.run(command, env=environment, check=True)
    return folder / SOFTWARE_ENV / "firmware.elf"


def pair(elf: Path, period_ms: int, seconds: float) -> Pair:
    """Runs two of them."""
    with Array(elf, 2, [(0, SOUTH, 1, NORTH)], PAIR_PPM, PAIR_START_S) as array:
        array.run(0.05)
        address, size = array.symbol("period_ms")
        for tile in array:
            tile.write_memory(address - DATA_SPACE, period_ms.to_bytes(size, "little"))
        array.run(0.2)
        before = _counts(array)
        array.run(seconds)
        counts = [now - then for now, then in zip(_counts(array), before, strict=True)]
    return Pair(period_ms, (counts[0], counts[1]), (counts[2], counts[3]))


def _counts(array: Array) -> list[int]:
    """Sent by the upper board's software, received below, sent by the lower board's USART, received above."""

    def word(tile: int, name: str, side: int) -> int:
        return int.from_bytes(array[tile].variable(name)[4 * side : 4 * side + 4], "little")

    return [
        word(0, "frames_sent", 0),
        word(1, "frames_received", 1),
        word(1, "frames_sent", 1),
        word(0, "frames_received", 0),
    ]


def lost(sent: int, received: int) -> str:
    """The share that never arrived whole, or "all N" if every frame arrived."""
    return f"{(sent - received) / sent:.1%} of {sent:,}" if received < sent else f"0 of {sent:,}"


def frames_lost(frames: soak.Frames) -> str:
    """Damaged frames and all."""
    return f"{frames.damaged:,} of {frames.received + frames.damaged:,}"


def links_table(seconds: float, pair_seconds: float) -> list[str]:
    """Frames lost, ours and theirs."""
    with tempfile.TemporaryDirectory() as folder:
        soaked = soak.soak(cost_fit.build(soak.small_model(), Path(folder)), soak.PERIOD_MS, seconds)
    kinds = (
        ("between USARTs", soaked.hardware),
        ("to the software side", soaked.to_software),
        ("from the software side", soaked.from_software),
    )
    note(*(exact(f"links: frames lost {words}", frames.damaged, "frames") for words, frames in kinds))
    rows = [
        f"| this firmware, every {soak.PERIOD_MS} ms, all four sides, awake {soaked.awake:.0%} | "
        f"{frames_lost(soaked.to_software)} | {frames_lost(soaked.from_software)} | "
        f"{frames_lost(soaked.hardware)} |"
    ]
    elf = software_serial()
    for period_ms in PERIODS_MS:
        found = pair(elf, period_ms, pair_seconds)
        how = f"every {period_ms} ms" if period_ms else "as fast as it goes"
        rows.append(
            f"| Arduino's SoftwareSerial, {how}, one side, no network | "
            f"{lost(*found.to_software)} | {lost(*found.from_software)} | |"
        )
    return [
        "| frames lost | to the software side | from it | between USARTs |",
        "|---|---|---|---|",
        *rows,
        "",
        f"Twenty tiles in a block, hidden layers of {soak.SMALL.hidden1} and {soak.SMALL.hidden2}, clocks of "
        f"neighbours 1 % apart, {soaked.restarts} restarts in {soaked.seconds:.0f} s. SoftwareSerial: two "
        f"boards, the same frames in both directions at 38,400 baud, {pair_seconds:.0f} s.",
    ]


def account_tables(found: profile.Account) -> list[str]:
    """The use of time, and the interrupts."""
    parts = found.shares | {f"of it, to hear side {side}": part for side, part in found.neighbours.items()}
    rows = [f"| {part} | {share:.2%} | {share * found.period_ms:.2f} |" for part, share in parts.items()]
    each = [
        f"| {one.name} | {one.per_s:,.0f} | {one.mean:.1f} | {one.longest} | {one.share:.2%} |"
        for one in found.interrupts
    ]
    return [
        f"| four neighbours, an update every {found.period_ms} ms | of a tile's time | ms per update |",
        "|---|---|---|",
        *rows,
        *(f"| {moment} | | {ms:.2f} |" for moment, ms in found.worst_ms.items()),
        "",
        "| interrupt | per second | cycles, mean | longest | of the time |",
        "|---|---|---|---|---|",
        *each,
        "",
        "Cycles from the interrupt's entry to the end of its return.",
    ]


def main() -> int:
    """Prints the tables, and writes them if asked to."""
    parser = argparse.ArgumentParser(description="What the links do and where a tile's time goes.")
    parser.add_argument("elf", type=Path, help="the image, as .pio/build/megaatmega2560/firmware.elf")
    parser.add_argument("--write", type=Path, metavar="F", help="put the tables into this document")
    parser.add_argument("--seconds", type=float, default=40.0, help="of the soak (default: %(default)s)")
    args = parser.parse_args()
    defaults = firmware_settings(args.elf)
    period_ms = defaults.period_ms if defaults else 100
    section = "\n".join(
        [*links_table(args.seconds, args.seconds / 2), "", *account_tables(profile.account(period_ms, 5.0))]
    )
    publish(section, args.write, BEGIN, END)
    return 0


if __name__ == "__main__":
    sys.exit(main())
