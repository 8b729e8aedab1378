"""Many emulated tiles on one clock: the Python interface of the C++ array."""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from tilenca.base.errors import TilencaError, UsageError, image_error
from tilenca.base.sides import SIDES
from tilenca.emulator.hardware import USUAL, Hardware
from tilenca.emulator.library import call, library, new, text
from tilenca.emulator.tile import DATA_SPACE, EmulatedTile
from tilenca.emulator.translation import Translator

MOST_DELAY_S = 1.0
# What a cable takes. Tiles run in turns a little shorter than it; docs/EMULATOR.md says why nothing can tell.
CABLE_DELAY_S = 260e-6

# A link joins a side of one tile to a side of another: (tile, side, other tile, other side), tiles from 0.
Link = tuple[int, int, int, int]


@dataclass(frozen=True)
class LinkFault:
    """What goes wrong in one direction of a cable.

    Attributes:
        loss: share of the bytes that never arrive, 0..1.
        flip: share of the data bits that arrive inverted, 0..1.
        delay_s: seconds more than the array's cables usually take.
        baud: how fast bytes are on it; 0: as the USART at either end is set.
    """

    loss: float = 0.0
    flip: float = 0.0
    delay_s: float = 0.0
    baud: float = 0.0


@dataclass(frozen=True)
class FaultCounts:
    """What a faulty direction has done: bytes that entered it, bytes it lost, bits it inverted."""

    bytes: int
    lost: int
    flipped: int


class Array:
    """Tiles in lockstep. Index it to reach a tile; close it, or use it in a `with` statement, to free it."""

    def __init__(
        self,
        image: Path | str,
        tiles: int = 1,
        links: Sequence[Link] = (),
        ppm: Sequence[float] | None = None,
        switch_on_s: Sequence[float] | None = None,
        bootloader: Path | str | None = None,
        threads: int = 1,
        cable_delay_s: float = CABLE_DELAY_S,
        translated: bool = True,
        hardware: Hardware = USUAL,
    ) -> None:
        """Builds the tiles; nothing runs yet.

        Args:
            image: ELF or Intel HEX file that all tiles run.
            tiles: how many.
            links: the cables.
            ppm: each tile's clock error in parts per million; default none.
            switch_on_s: when each tile is switched on, in seconds; default 0.
            bootloader: image for the boot section; with one, the tiles start there after every reset.
            threads: how many share the work; they change nothing else.
            cable_delay_s: seconds from a pin to the pin at the other end of a cable, 20e-6 to 260e-6; the
                longer, the less time the emulation takes.
            translated: whether to use a translation of the image, if there is one; it changes nothing else.
            hardware: how far the boards differ from ideal ones; `IDEAL` are.

        Raises:
            BuildError: the emulator is not built.
            BuildError, UsageError: an image cannot be read or is for another chip; see `image_error`.
            UsageError: the lists do not fit the number of tiles, or another number is out of range.
        """
        self._handle: Any = None
        ppm, switch_on_s = list(ppm or [0.0] * tiles), list(switch_on_s or [0.0] * tiles)
        if tiles < 1 or len(ppm) != tiles or len(switch_on_s) != tiles:
            raise UsageError(
                f"an array of {tiles} tiles got {len(ppm)} clock errors and {len(switch_on_s)} switch-on "
                "times; give one of each per tile"
            )
        path = new("char[]", os.fsencode(image))
        boot = library().ffi.NULL if bootloader is None else new("char[]", os.fsencode(bootloader))
        try:
            self._handle = call("array_new", path, boot, tiles, ppm, switch_on_s)
        except UsageError as error:
            raise image_error(str(error)) from None
        hardware.apply(self._handle, bootloader is not None)
        call("array_set_cable_delay", self._handle, cable_delay_s)
        self._translator = Translator(Path(image), translated)
        self._translator.use(self._handle)
        self._tiles = [EmulatedTile(self, index) for index in range(tiles)]
        for link in links:
            self.link(*link)
        self.set_threads(threads)

    @property
    def handle(self) -> Any:
        """The array as the C library knows it.

        Raises:
            UsageError: it has been closed.
        """
        if self._handle is None:
            raise UsageError("the array is closed; build another")
        return self._handle

    @property
    def is_translated(self) -> bool:
        """Whether the tiles execute translated blocks; `tilenca.emulator.translation` says what that is."""
        return self._translator.in_use

    # --- tiles and cables, also while it runs ---

    def add_tile(self, ppm: float = 0.0, switch_on_s: float | None = None) -> EmulatedTile:
        """One more tile, switched on at that time (default: now), without cables."""
        start_s = self.time_s if switch_on_s is None else switch_on_s
        call("array_add_tile", self.handle, ppm, start_s)
        self._tiles.append(EmulatedTile(self, len(self._tiles)))
        return self._tiles[-1]

    def remove_tile(self, tile: int) -> None:
        """Switches a tile off and takes its cables away; the others keep their numbers."""
        self._check_end(tile, 0)
        call("array_remove_tile", self.handle, tile)

    def link(self, tile: int, side: int, other: int, other_side: int) -> None:
        """Lays a cable between two sides."""
        self._check_end(tile, side)
        self._check_end(other, other_side)
        if tile == other:
            raise UsageError(f"link {(tile, side, other, other_side)}: a cable joins two tiles")
        call("array_link", self.handle, tile, side, other, other_side)

    def unlink(self, tile: int, side: int) -> None:
        """Takes the cable at a side away."""
        self._check_end(tile, side)
        call("array_unlink", self.handle, tile, side)

    def cut(self, tile: int, side: int) -> None:
        """Cuts the cable at a side: nothing gets through any more, and nobody drives its ends."""
        self._check_end(tile, side)
        call("array_connect", self.handle, tile, side, False)

    def mend(self, tile: int, side: int) -> None:
        """Mends a cable that was cut."""
        self._check_end(tile, side)
        call("array_connect", self.handle, tile, side, True)

    def set_fault(self, tile: int, side: int, fault: LinkFault, seed: int = 0) -> None:
        """Spoils the direction that leaves a side, from now on; `LinkFault()` makes it whole again.

        Raises:
            UsageError: no cable there, or a number out of range.
        """
        self._check_end(tile, side)
        in_range = 0 <= fault.loss <= 1 and 0 <= fault.flip <= 1 and 0 <= fault.delay_s <= MOST_DELAY_S
        if not in_range or fault.baud < 0:
            raise UsageError(f"{fault}: loss and flip are 0 to 1, delay_s 0 to {MOST_DELAY_S}, baud above 0")
        number = seed * len(self) * len(SIDES) + tile * len(SIDES) + side
        given = new("tilenca_wire_fault*", (fault.loss, fault.flip, fault.delay_s, fault.baud))
        call("array_set_fault", self.handle, tile, side, given, number % 2**64)

    def fault_counts(self, tile: int, side: int) -> FaultCounts:
        """What the direction that leaves a side has lost and flipped, while it was told to."""
        self._check_end(tile, side)
        counts = new("tilenca_wire_counts*")
        call("array_fault_counts", self.handle, tile, side, counts)
        return FaultCounts(counts.bytes, counts.lost, counts.flipped)

    def _check_end(self, tile: int, side: int) -> None:
        if not 0 <= tile < len(self) or not 0 <= side < len(SIDES):
            raise UsageError(
                f"tile {tile}, side {side}: tiles are 0 to {len(self) - 1}, sides 0 to 3 (N E S W)"
            )

    # --- time ---

    def set_threads(self, threads: int) -> None:
        """How many threads share the work; they change nothing else."""
        if threads < 1:
            raise UsageError(f"{threads} threads; at least 1")
        call("array_set_threads", self.handle, threads)

    def run(self, seconds: float) -> None:
        """Runs all tiles for a while; returns early while a tile is halted at a breakpoint.

        Raises:
            TilencaError: a tile stopped at a fault; the message names tile, place and fact.
        """
        stopped = call("array_run", self.handle, seconds)
        self._translator.note(self._handle, seconds * len(self))
        if stopped:
            raise TilencaError(next(tile.fault for tile in self._tiles if tile.fault))

    @property
    def time_s(self) -> float:
        """Seconds of emulated time since the array began, a whole number of 16 us."""
        return float(call("array_time", self.handle))

    @property
    def halted(self) -> list[EmulatedTile]:
        """The tiles that stand before a breakpoint."""
        return [tile for tile in self._tiles if tile.halted]

    # --- snapshots ---

    def save(self) -> bytes:
        """Everything that decides about the future: tiles, what is on the cables, cables, faults.

        Breakpoints, marks, probes and taps are the debugger's, and stay out.
        """
        start = new("uint8_t*[]", 1)
        count = call("array_save", self.handle, start)
        return bytes(library().ffi.buffer(start[0], count))

    def restore(self, snapshot: bytes) -> None:
        """Goes to the moment at which `save` was called, in this array or another of the same image.

        Raises:
            UsageError: it is no snapshot, or of another image. The array is of no use then, unless another
                `restore` succeeds.
        """
        try:
            call("array_load", self.handle, snapshot, len(snapshot))
        except UsageError as error:
            raise UsageError(f"snapshot: {error}; save it anew") from None
        count = call("array_size", self.handle)
        for tile in self._tiles[count:]:
            tile.retire()
        del self._tiles[count:]
        while len(self._tiles) < count:
            self._tiles.append(EmulatedTile(self, len(self._tiles)))

    # --- the image's symbols ---

    def symbol(self, name: str) -> tuple[int, int]:
        """Address and size in bytes of a symbol of the ELF file; data memory begins at 0x800000.

        Raises:
            UsageError: there is none of that name.
        """
        address, size = new("uint32_t*"), new("uint32_t*")
        call("array_symbol", self.handle, name.encode(), address, size)
        return address[0], size[0]

    def code_address(self, place: str | int) -> int:
        """The byte address in flash of a function, or the number given."""
        address = self.symbol(place)[0] if isinstance(place, str) else place
        if address >= DATA_SPACE:
            raise UsageError(f"'{place}' is no function; give a function's name or an address in flash")
        return address

    def function_at(self, address: int) -> str:
        """The function that contains a byte of flash, or ""."""
        return text(call("array_function_at", self.handle, address))

    def __len__(self) -> int:
        return len(self._tiles)

    def __getitem__(self, index: int) -> EmulatedTile:
        return self._tiles[index]

    def __iter__(self) -> Iterator[EmulatedTile]:
        return iter(self._tiles)

    def close(self) -> None:
        """Frees the tiles; the array cannot be used afterwards."""
        if self._handle is not None:
            call("array_free", self._handle)
            self._handle = None

    def __del__(self) -> None:
        self.close()

    def __enter__(self) -> "Array":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
