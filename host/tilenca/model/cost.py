"""Whether a network fits a tile, computed from its widths alone and so before it is trained.

    print(cost.check(Dimensions(37, 64, 64), classes=26))

Flash holds the weights; SRAM is the same for all networks, since the firmware's buffers are sized for the
widest. A wider network costs time.
"""

import configparser
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from tilenca.base import paths
from tilenca.base.errors import BuildError, UsageError
from tilenca.model import packing
from tilenca.model.file import MAX_WIDTH, NEIGHBOURHOOD, Dimensions
from tilenca.protocol.constants import CRC_SIZE, HEADER_SIZE, LINK_BAUD, MAX_CHANNELS, MIN_PERIOD_MS

# LPM reaches the low 64 KiB of flash; the vectors and other constants want their part of it.
MAX_FLASH_BYTES = 60 * 1024
LOOK_BYTES = 5
MAX_LAYER_BYTES = 32767  # avr-gcc takes no larger array

SRAM_BYTES = 8192
# Variables and the deepest stack, less what `buffer_bytes` counts.
OTHER_SRAM_BYTES = 2888

# The share of each layer's inputs that is not zero: with four neighbours, the models that ship have no more.
# An update without a zero takes some of HEAD_ROOM.
ACTIVE = (1.0, 0.6, 0.4)
# What one of the first sixty updates of a tile takes of the time for so many, on average: those know less.
AVERAGE = 0.955

# Cycles awake of a tile with four neighbours, all told: network, links, display, telemetry. Measured on the
# emulated chip and fitted by tools/firmware/cost_fit.py, which prints new ones when the firmware changes.
CYCLES_PER_MAC = 8.3783
CYCLES_PER_SKIPPED = 1.3744
CYCLES_PER_CHANNEL = 2504.0
CYCLES_PER_UPDATE = 45055.0
CYCLES_PER_MS = 1572.0  # updating or not

CLOCK_PER_MS = 16_000
BITS_PER_BYTE = 10
TOGGLES_PER_BYTE = 7
FRAMING_BYTES = 2  # COBS and the delimiter
# The part of the time that stays free at the shortest period; clocks drift, and telemetry comes in bursts.
HEAD_ROOM = 0.08


@dataclass(frozen=True)
class Fit:
    """The cost of a network on a tile; `str()` of it is one line for people.

    Attributes:
        macs: multiplications of one update.
        flash_bytes: weights, biases and looks.
        buffer_bytes: bytes that it uses of the buffers in SRAM.
        sram_bytes: bytes of SRAM that the firmware takes with any network, stack included.
        update_cycles: clock cycles that one update costs, all told, whatever the period, with ACTIVE inputs.
        shortest_period_ms: the shortest period that leaves HEAD_ROOM of the chip's and the lines' time free.
        period_ms: the period it is to run at.
    """

    dimensions: Dimensions
    classes: int
    macs: int
    flash_bytes: int
    buffer_bytes: int
    sram_bytes: int
    update_cycles: float
    shortest_period_ms: int
    period_ms: int

    @property
    def awake_cycles(self) -> float:
        """Cycles that a tile with four neighbours is awake per period; more than the period has: too slow."""
        return self.update_cycles + CYCLES_PER_MS * self.period_ms

    @property
    def load(self) -> float:
        """Share of its time that the chip is awake; above 1 it does not keep up."""
        return self.awake_cycles / (CLOCK_PER_MS * self.period_ms)

    @property
    def fits_period(self) -> bool:
        """Whether updates are done in time, with head-room."""
        return self.shortest_period_ms <= self.period_ms

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        size = self.dimensions
        return {
            "channels": size.channels,
            "hidden1": size.hidden1,
            "hidden2": size.hidden2,
            "classes": self.classes,
            "macs": self.macs,
            "flash_bytes": self.flash_bytes,
            "flash_limit": MAX_FLASH_BYTES,
            "buffer_bytes": self.buffer_bytes,
            "sram_bytes": self.sram_bytes,
            "sram_limit": SRAM_BYTES,
            "update_cycles": round(self.update_cycles),
            "update_ms": round(self.update_cycles / CLOCK_PER_MS, 1),
            "busy": round(self.load, 3),
            "shortest_period_ms": self.shortest_period_ms,
            "period_ms": self.period_ms,
            "fits": self.fits_period,
        }

    def __str__(self) -> str:
        what = "fits a tile" if self.fits_period else "fits a tile's memory, but not its period"
        remedy = "" if self.fits_period else "; set TILENCA_PERIOD_MS in platformio.ini"
        return (
            f"{what}: {self.flash_bytes:,} bytes of flash, {self.update_cycles / CLOCK_PER_MS:.0f} ms of "
            f"work per update; period {self.period_ms} ms, at least {self.shortest_period_ms} ms{remedy}"
        )


def macs(size: Dimensions) -> int:
    """Multiplications of one update."""
    return sum(math.prod(shape) for name, shape in size.shapes().items() if name.startswith("w"))


def layer_bytes(size: Dimensions) -> list[int]:
    """Bytes of flash that each layer takes: weights and biases of whole blocks."""
    weights = (shape for name, shape in size.shapes().items() if name.startswith("w"))
    return [packing.layer_bytes(inputs, outputs) for outputs, inputs in weights]


def flash_bytes(size: Dimensions, classes: int) -> int:
    """Bytes of flash that the model's arrays take: layers and looks."""
    return sum(layer_bytes(size)) + LOOK_BYTES * classes


def frame_bytes(channels: int) -> int:
    """Bytes of a frame on the wire."""
    return HEADER_SIZE + channels + CRC_SIZE + FRAMING_BYTES


def buffer_bytes(size: Dimensions) -> int:
    """Bytes that a network uses of the firmware's buffers.

    All of them are sized for MAX_CHANNELS and MAX_WIDTH: state and inputs of core/cell.h, hidden activations
    of core/network.h, for each of four sides the message of core/link.h and the decoder's bytes of
    core/frame.h, and the bits of a frame of core/toggles.h.
    """
    channels = size.channels
    cell = 2 * channels + 5 * channels
    # Whole blocks, and at least one byte behind the last activation.
    hidden = sum(
        (width // packing.BLOCK_OUTPUTS + 1) * packing.BLOCK_OUTPUTS for width in (size.hidden1, size.hidden2)
    )
    links = 4 * (channels + (HEADER_SIZE + channels + CRC_SIZE + 1))
    toggles = -(-frame_bytes(channels) * BITS_PER_BYTE // TOGGLES_PER_BYTE) + 1
    return cell + hidden + links + toggles


WIDEST_BUFFERS = buffer_bytes(Dimensions(MAX_CHANNELS, MAX_WIDTH, MAX_WIDTH))


def weights_read(size: Dimensions, active: Sequence[float] = ACTIVE) -> tuple[float, float]:
    """Weights that one update multiplies, those of absent outputs included, and those that it skips."""
    shapes = [shape for name, shape in size.shapes().items() if name.startswith("w")]
    held = [packing.padded(outputs) * inputs for outputs, inputs in shapes]
    multiplied = sum(count * share for count, share in zip(held, active, strict=True))
    return multiplied, sum(held) - multiplied


def update_cycles(size: Dimensions, active: Sequence[float] = ACTIVE) -> float:
    """Cycles that one update costs a tile with four neighbours, without what it costs to be awake at all."""
    multiplied, skipped = weights_read(size, active)
    return (
        CYCLES_PER_MAC * multiplied
        + CYCLES_PER_SKIPPED * skipped
        + CYCLES_PER_CHANNEL * size.channels
        + CYCLES_PER_UPDATE
    )


def computing_ms(size: Dimensions, neighbours: int) -> float:
    """Milliseconds that one of a tile's first sixty updates takes on average, beside the chip's other work.

    Args:
        size: of the network.
        neighbours: how many the tile has; the messages of absent ones are zeros, which are skipped.
    """
    multiplied, skipped = weights_read(size, ((1 + neighbours) / NEIGHBOURHOOD, *ACTIVE[1:]))
    cycles = CYCLES_PER_MAC * multiplied + CYCLES_PER_SKIPPED * skipped
    return AVERAGE * cycles / (CLOCK_PER_MS - CYCLES_PER_MS)


def shortest_period_ms(size: Dimensions) -> int:
    """The shortest period that leaves HEAD_ROOM of the chip's and of the lines' time free."""
    usable = 1 - HEAD_ROOM
    computing = update_cycles(size) / (usable * CLOCK_PER_MS - CYCLES_PER_MS)
    sending = frame_bytes(size.channels) * BITS_PER_BYTE * 1000 / LINK_BAUD / usable
    return math.ceil(max(computing, sending, MIN_PERIOD_MS))


def estimate(size: Dimensions, classes: int, period_ms: int) -> Fit:
    """What a network of these widths costs; a pure function."""
    return Fit(
        dimensions=size,
        classes=classes,
        macs=macs(size),
        flash_bytes=flash_bytes(size, classes),
        buffer_bytes=buffer_bytes(size),
        sram_bytes=OTHER_SRAM_BYTES + WIDEST_BUFFERS,
        update_cycles=update_cycles(size),
        shortest_period_ms=shortest_period_ms(size),
        period_ms=period_ms,
    )


def firmware_period_ms() -> int:
    """The period that platformio.ini builds into the firmware of the project, else into the shipped image.

    Raises:
        BuildError: it names none.
    """
    path = (paths.PROJECT or paths.ROOT) / paths.PLATFORMIO_INI
    project = configparser.ConfigParser(interpolation=None)
    try:
        project.read_string(path.read_text(encoding="utf-8"))
        flags = project[f"env:{paths.FIRMWARE_ENV}"]["build_flags"]
    except (OSError, UnicodeDecodeError, configparser.Error, KeyError) as error:
        raise BuildError(
            f"{path}: no build_flags of {paths.FIRMWARE_ENV}; check out the file again"
        ) from error
    period = re.search(r"TILENCA_PERIOD_MS=(\d+)", flags)
    if period is None or int(period[1]) < MIN_PERIOD_MS:
        raise BuildError(
            f"{path}: [env:{paths.FIRMWARE_ENV}] names no period; add -D TILENCA_PERIOD_MS=20 to build_flags"
        )
    return int(period[1])


def check(size: Dimensions, classes: int) -> Fit:
    """Refuses a network that no tile has room for; the period is told, not refused: it can be longer.

    Raises:
        UsageError: more classes than channels.
        BuildError: too wide, or too large for flash.
    """
    if not 1 <= classes <= size.max_classes:
        taken = "one is the seed's" + (" and 4 are the directions'" if size.directions else "")
        raise UsageError(
            f"{classes} classes need a state of at least {classes + 1 + size.directions} channels, {taken}; "
            f"this one has {size.channels}, give a wider --state"
        )
    if size.channels > MAX_CHANNELS or max(size.hidden1, size.hidden2) > MAX_WIDTH:
        raise BuildError(
            f"the model has {size.channels} channels and hidden layers of {size.hidden1} and {size.hidden2}; "
            f"the firmware has room for {MAX_CHANNELS} and {MAX_WIDTH}, train a narrower one"
        )
    largest = max(layer_bytes(size))
    if largest > MAX_LAYER_BYTES:
        raise BuildError(
            f"a layer of {largest} bytes, the compiler takes {MAX_LAYER_BYTES}; train with a smaller --hidden"
        )
    found = estimate(size, classes, firmware_period_ms())
    if found.flash_bytes > MAX_FLASH_BYTES:
        raise BuildError(
            f"{found.flash_bytes} bytes of weights, the firmware has room for {MAX_FLASH_BYTES}; train "
            "with a smaller --hidden"
        )
    return found
