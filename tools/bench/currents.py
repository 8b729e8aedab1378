"""What a tile with everything lit draws: python -m bench.currents [--write FILE].

The shares of time come from the firmware on an emulated tile, the resistors from the authors' netlist.
"""

import argparse
import sys
from itertools import pairwise
from pathlib import Path

from bench.publish import publish
from firmware.cost_fit import CROSS, MIDDLE
from tilenca.base import paths
from tilenca.base.sides import SIDES
from tilenca.emulator import Array
from tilenca.emulator.wiring import cables
from tilenca.protocol.constants import DEFAULT_PERIOD_MS, MAX_BRIGHTNESS
from tilenca.protocol.settings import settings_block
from tilenca.shapes.glyphs import look_of

BEGIN, END = "<!-- currents: made by `python -m bench.currents`, do not edit -->", "<!-- /currents -->"
SUPPLY_V = 5.0
LIMIT_MA = 150.0
CHIP_LIMIT_MA = 200.0  # data sheet, absolute maximum ratings: VCC and GND pins
SEGMENTS = 7
# Forward voltage and series resistor in ohm.
SEGMENT = (2.0, 300.0)
COLOURS = {"red": (2.0, 150.0), "green": (3.2, 100.0), "blue": (3.2, 100.0)}
LED_MA = 17.0
CORE_MA = 20.0
ARDUINO_MA = 30.0
START_S, WATCHED_S = 1.0, 1.0
BRIGHTNESSES = (255, 128, 64, 0)
LED_PORT = "K"  # bits 0 to 3: N E S W


def milliamperes(drop_v: float, ohm: float) -> float:
    """What flows through an LED that is lit."""
    return (SUPPLY_V - drop_v) / ohm * 1000


def led_share(brightness: int) -> float:
    """The sum of the four link LEDs' shares of time, measured: a tile with four neighbours."""
    with Array(paths.FIRMWARE_ELF, len(CROSS.cells), cables(CROSS)) as array:
        for tile in array:
            tile.write_eeprom(0, settings_block(tile.index + 1, DEFAULT_PERIOD_MS, 0, brightness))
        array.run(START_S)
        probes = [array[MIDDLE].probe(LED_PORT, bit) for bit in range(len(SIDES))]
        array.run(WATCHED_S)
        lit_s = 0.0
        for probe in probes:
            edges = probe.read()
            lit_s += sum(after.time_s - edge.time_s for edge, after in pairwise(edges) if edge.level)
        return round(lit_s / WATCHED_S, 2)


def brightest() -> tuple[str, float]:
    """The class whose colour draws most, and its mean current in mA at full brightness."""
    currents = {}
    for digit in range(10):
        duties = look_of(str(digit), digit).colour
        currents[str(digit)] = sum(
            milliamperes(*colour) * duty / 255 for colour, duty in zip(COLOURS.values(), duties, strict=True)
        )
    label = max(currents, key=currents.__getitem__)
    return label, currents[label]


def parts(brightness: int) -> dict[str, float]:
    """Mean currents in mA, by part, with a digit 8 in the brightest class's colour and four neighbours."""
    share = brightness / MAX_BRIGHTNESS
    return {
        "seven segments": SEGMENTS * milliamperes(*SEGMENT) * share,
        "RGB LED": brightest()[1] * share,
        "four link LEDs": LED_MA * led_share(brightness),
        "ATmega2560": CORE_MA,
        "USB bridge, ON light": ARDUINO_MA,
    }


def chip_peak_ma() -> float:
    """What the chip draws at most at one moment: pulses of colours may meet, those of link LEDs do not."""
    colours = sum(milliamperes(*colour) for colour in COLOURS.values())
    return SEGMENTS * milliamperes(*SEGMENT) + colours + LED_MA + CORE_MA


SOURCES = {
    "seven segments": f"({SUPPLY_V:g} V - {SEGMENT[0]:g} V) / {SEGMENT[1]:g} ohm each (netlist)",
    "RGB LED": "",
    "four link LEDs": f"{LED_MA:g} mA each (resistor: netlist; *check*), measured share of time",
    "ATmega2560": "16 MHz, awake (data sheet, typical characteristics)",
    "USB bridge, ON light": "of the Arduino (*check*)",
}


def table() -> list[str]:
    """The section of docs/HARDWARE.md."""
    columns = {brightness: parts(brightness) for brightness in BRIGHTNESSES}
    label, _ = brightest()
    sources = SOURCES | {
        "RGB LED": f"colour of {label}; "
        + ", ".join(f"{name} {milliamperes(*colour):.0f} mA" for name, colour in COLOURS.items())
        + " (netlist), times duty"
    }
    rows = [
        f"| {part} | {' | '.join(f'{columns[b][part]:.0f}' for b in BRIGHTNESSES)} | {source} |"
        for part, source in sources.items()
    ]
    totals = {b: sum(columns[b].values()) for b in BRIGHTNESSES}
    full = columns[MAX_BRIGHTNESS]
    all_lit = totals[MAX_BRIGHTNESS] - full["four link LEDs"] + len(SIDES) * LED_MA
    sums = " | ".join(f"**{total:.0f}**" for total in totals.values())
    return [
        f"| mA at `brightness` | {' | '.join(map(str, BRIGHTNESSES))} | from |",
        f"|---|{'---|' * len(BRIGHTNESSES)}---|",
        *rows,
        f"| **together** | {sums} | at most {LIMIT_MA:g} |",
        "",
        "A digit 8, four neighbours. Four link LEDs that are lit all the time would make it "
        f"{all_lit:.0f} mA. The chip alone draws at most {chip_peak_ma():.0f} mA at one moment:",
        "all segments, all three colours, one link LED, the core. Its limit is "
        f"{CHIP_LIMIT_MA:g} mA (data sheet, absolute maximum ratings).",
    ]


def main() -> int:
    """Prints the table, and writes it if asked to."""
    parser = argparse.ArgumentParser(description="What a tile with everything lit draws.")
    parser.add_argument("--write", type=Path, metavar="F", help="put the table into this document")
    args = parser.parse_args()
    publish("\n".join(table()), args.write, BEGIN, END)
    return 0


if __name__ == "__main__":
    sys.exit(main())
