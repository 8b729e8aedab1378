"""Emulated tiles: whole ATmega2560 boards, wired side to side, running a firmware image cycle by cycle.

The work is done by the C++ library that `make setup` builds from tools/emulator; this is its Python face.

    from tilenca.emulator import Array
    from tilenca.paths import FIRMWARE_ELF

    with Array(FIRMWARE_ELF, tiles=2, links=[(0, EAST, 1, WEST)], ppm=[1000, -1000]) as array:
        array.run(1.0)
        print(array[0].segments, array[1].rgb, array[0].read_serial())

Everything is deterministic: the same calls give the same results, to the cycle.
"""

import ctypes
import os
from collections.abc import Iterator, Sequence
from ctypes import (
    POINTER,
    c_char,
    c_char_p,
    c_double,
    c_int,
    c_size_t,
    c_uint,
    c_uint8,
    c_uint32,
    c_uint64,
    c_void_p,
)
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import TracebackType

from tilenca.errors import BuildError, TilencaError, UsageError, image_error
from tilenca.paths import BUILD

LIBRARY = BUILD / "emulator" / "libtilenca_emulator.so"
NORTH, EAST, SOUTH, WEST = range(4)
EEPROM_BYTES = 4096
RECEIVE_CHUNK = 4096

# A link joins a side of one tile to a side of another: (tile, side, other tile, other side), tiles from 0.
Link = tuple[int, int, int, int]

_SIGNATURES: dict[str, tuple[type | None, list[type]]] = {
    "last_error": (c_char_p, []),
    "array_new": (c_void_p, [c_char_p, c_char_p, c_uint, POINTER(c_double), POINTER(c_double)]),
    "array_free": (None, [c_void_p]),
    "array_link": (c_int, [c_void_p, c_uint, c_uint, c_uint, c_uint]),
    "array_run": (c_int, [c_void_p, c_double]),
    "array_time": (c_double, [c_void_p]),
    "tile_fault": (c_char_p, [c_void_p, c_uint]),
    "tile_warning": (c_char_p, [c_void_p, c_uint, c_uint]),
    "tile_segments": (c_int, [c_void_p, c_uint]),
    "tile_leds": (c_int, [c_void_p, c_uint]),
    "tile_rgb": (None, [c_void_p, c_uint, POINTER(c_uint8)]),
    "tile_press_button": (None, [c_void_p, c_uint, c_int]),
    "tile_reset": (None, [c_void_p, c_uint]),
    "tile_pin": (c_int, [c_void_p, c_uint, c_char, c_uint]),
    "tile_duty": (c_double, [c_void_p, c_uint, c_char, c_uint]),
    "tile_hold_pin": (c_int, [c_void_p, c_uint, c_char, c_uint, c_int]),
    "tile_set_analog": (None, [c_void_p, c_uint, c_uint, c_uint]),
    "tile_push_edge": (c_int, [c_void_p, c_uint, c_char, c_uint, c_uint64, c_int]),
    "tile_send": (None, [c_void_p, c_uint, c_char_p, c_size_t]),
    "tile_receive": (c_size_t, [c_void_p, c_uint, POINTER(c_uint8), POINTER(c_double), c_size_t]),
    "tile_display_changes": (
        c_size_t,
        [c_void_p, c_uint, c_size_t, POINTER(c_double), POINTER(c_uint8), c_size_t],
    ),
    "tile_read_eeprom": (c_int, [c_void_p, c_uint, c_uint, POINTER(c_uint8), c_uint]),
    "tile_write_eeprom": (c_int, [c_void_p, c_uint, c_uint, c_char_p, c_uint]),
    "tile_read_memory": (c_int, [c_void_p, c_uint, c_uint, POINTER(c_uint8), c_uint]),
    "tile_read_flash": (c_int, [c_void_p, c_uint, c_uint, POINTER(c_uint8), c_uint]),
    "tile_cycles": (None, [c_void_p, c_uint, POINTER(c_uint64), POINTER(c_uint64)]),
    "tile_pc": (c_uint32, [c_void_p, c_uint]),
}


@cache
def _library() -> ctypes.CDLL:
    """The compiled emulator; ctypes lets other Python threads run while it works.

    Raises:
        BuildError: it has not been built.
    """
    try:
        library = ctypes.CDLL(os.fspath(LIBRARY))
    except OSError as error:
        raise BuildError(f"{LIBRARY}: the emulator is not built ({error}); run `make setup`") from error
    for name, (result, arguments) in _SIGNATURES.items():
        function = getattr(library, f"tilenca_{name}")
        function.restype, function.argtypes = result, arguments
    return library


@dataclass(frozen=True)
class DisplayChange:
    """A tile's display began to show something else.

    Attributes:
        time_s: seconds since the array began, to 16 us.
        segments: bit mask as in `tilenca.glyphs`.
    """

    time_s: float
    segments: int


class EmulatedTile:
    """One tile of an array, as eyes, fingers, cables and a debugger reach it. Made by `Array`."""

    def __init__(self, array: "Array", index: int) -> None:
        self._array = array
        self.index = index

    @property
    def segments(self) -> int:
        """The lit segments: bit 0 = a ... bit 6 = g, bit 7 = dp, as in `tilenca.glyphs`."""
        return int(_library().tilenca_tile_segments(self._array.handle, self.index))

    @property
    def rgb(self) -> tuple[int, int, int]:
        """Duty of the red, green and blue LED now, 0..255 each, as the pins give it."""
        duty = (c_uint8 * 3)()
        _library().tilenca_tile_rgb(self._array.handle, self.index, duty)
        return duty[0], duty[1], duty[2]

    @property
    def leds(self) -> tuple[bool, bool, bool, bool]:
        """The four debug LEDs, in the order N E S W."""
        mask = _library().tilenca_tile_leds(self._array.handle, self.index)
        return bool(mask & 1), bool(mask & 2), bool(mask & 4), bool(mask & 8)

    @property
    def display_changes(self) -> list[DisplayChange]:
        """Everything the display has shown, in order; it is dark until the first change."""
        library, handle = _library(), self._array.handle
        count = library.tilenca_tile_display_changes(handle, self.index, 0, None, None, 0)
        times, segments = (c_double * count)(), (c_uint8 * count)()
        library.tilenca_tile_display_changes(handle, self.index, 0, times, segments, count)
        return [DisplayChange(time, lit) for time, lit in zip(times, segments, strict=True)]

    @property
    def fault(self) -> str:
        """What stopped the tile (tile, address, function, fact), or "" while it runs."""
        return str(_library().tilenca_tile_fault(self._array.handle, self.index).decode())

    @property
    def warnings(self) -> list[str]:
        """Functions of the chip that the program asked for and that are not modelled, each once."""
        found: list[str] = []
        while text := _library().tilenca_tile_warning(self._array.handle, self.index, len(found)):
            found.append(text.decode())
        return found

    @property
    def cycles(self) -> tuple[int, int]:
        """Clock cycles since the tile was switched on: in all, and asleep."""
        total, asleep = c_uint64(), c_uint64()
        _library().tilenca_tile_cycles(self._array.handle, self.index, total, asleep)
        return total.value, asleep.value

    @property
    def pc(self) -> int:
        """Byte address in flash of the next instruction."""
        return int(_library().tilenca_tile_pc(self._array.handle, self.index))

    def press_button(self, pressed: bool = True) -> None:
        """Holds the push button down, or lets it go."""
        _library().tilenca_tile_press_button(self._array.handle, self.index, pressed)

    def reset(self) -> None:
        """Resets the chip from outside, as opening its USB serial port does."""
        _library().tilenca_tile_reset(self._array.handle, self.index)

    def write_serial(self, data: bytes) -> None:
        """Queues bytes for the tile's USB serial; they arrive while the array runs, at the tile's speed."""
        _library().tilenca_tile_send(self._array.handle, self.index, data, len(data))

    def read_serial(self) -> bytes:
        """Everything the tile has sent on its USB serial since the last read."""
        return bytes(byte for _, byte in self.read_serial_timed())

    def read_serial_timed(self) -> list[tuple[float, int]]:
        """Like `read_serial`, each byte with the time in seconds at which it had arrived."""
        received: list[tuple[float, int]] = []
        room = RECEIVE_CHUNK
        values, times = (c_uint8 * room)(), (c_double * room)()
        while count := _library().tilenca_tile_receive(self._array.handle, self.index, values, times, room):
            received.extend(zip(times[:count], values[:count], strict=True))
        return received

    def read_eeprom(self, address: int = 0, count: int = EEPROM_BYTES) -> bytes:
        """Bytes of the EEPROM.

        Raises:
            UsageError: the range ends beyond the memory (this holds for all four readers and writers).
        """
        return self._read("read_eeprom", address, count)

    def write_eeprom(self, address: int, data: bytes) -> None:
        """Puts bytes into the EEPROM at once, as a programmer does before the tile is switched on."""
        done = _library().tilenca_tile_write_eeprom(self._array.handle, self.index, address, data, len(data))
        _check(done == 0)

    def read_memory(self, address: int, count: int) -> bytes:
        """Bytes of the data space as stored: registers from 0, I/O from 0x20, SRAM from 0x200."""
        return self._read("read_memory", address, count)

    def read_flash(self, address: int, count: int) -> bytes:
        """Bytes of the program memory."""
        return self._read("read_flash", address, count)

    def pin(self, port: str, bit: int) -> bool:
        """The level of a pin, such as `pin("K", 7)`."""
        level = _library().tilenca_tile_pin(self._array.handle, self.index, port.encode(), bit)
        _check(level >= 0)
        return bool(level)

    def duty(self, port: str, bit: int) -> float:
        """Share of time (0..1) an output is high under its timer's PWM; 0 for an input."""
        duty = _library().tilenca_tile_duty(self._array.handle, self.index, port.encode(), bit)
        _check(duty >= 0)
        return float(duty)

    def hold_pin(self, port: str, bit: int, level: bool) -> None:
        """Drives an input from outside; an input that nobody drives reads high."""
        _check(
            _library().tilenca_tile_hold_pin(self._array.handle, self.index, port.encode(), bit, level) == 0
        )

    def set_analog(self, channel: int, value: int) -> None:
        """What analog input A0 to A15 converts to, 0..1023."""
        _library().tilenca_tile_set_analog(self._array.handle, self.index, channel, value)

    def push_edge(self, port: str, bit: int, cycle: int, level: bool) -> None:
        """Lets an input change at a future cycle of the tile's own clock; not for pins that a link drives."""
        _check(
            _library().tilenca_tile_push_edge(
                self._array.handle, self.index, port.encode(), bit, cycle, level
            )
            == 0
        )

    def _read(self, what: str, address: int, count: int) -> bytes:
        buffer = (c_uint8 * count)()
        _check(
            getattr(_library(), f"tilenca_tile_{what}")(
                self._array.handle, self.index, address, buffer, count
            )
            == 0
        )
        return bytes(buffer)


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
    ) -> None:
        """Builds the tiles; nothing runs yet.

        Args:
            image: ELF or Intel HEX file that all tiles run.
            tiles: how many.
            links: the cables.
            ppm: each tile's clock error in parts per million; default none.
            switch_on_s: when each tile is switched on, in seconds; default 0.
            bootloader: image for the boot section; with one, the tiles start there after every reset.

        Raises:
            BuildError: the emulator is not built.
            BuildError, UsageError: an image cannot be read or is for another chip; see `image_error`.
            UsageError: the lists do not fit the number of tiles.
        """
        self.handle: int | None = None
        ppm, switch_on_s = ppm or [0.0] * tiles, switch_on_s or [0.0] * tiles
        if tiles < 1 or len(ppm) != tiles or len(switch_on_s) != tiles:
            raise UsageError(
                f"an array of {tiles} tiles got {len(ppm)} clock errors and {len(switch_on_s)} switch-on "
                "times; give one of each per tile"
            )
        library = _library()
        doubles = c_double * tiles
        boot = None if bootloader is None else os.fsencode(bootloader)
        self.handle = library.tilenca_array_new(
            os.fsencode(image), boot, tiles, doubles(*ppm), doubles(*switch_on_s)
        )
        if not self.handle:
            raise image_error(library.tilenca_last_error().decode())
        self._tiles = [EmulatedTile(self, index) for index in range(tiles)]
        for link in links:
            self._link(link)

    def _link(self, link: Link) -> None:
        tile, side, other, other_side = link
        if (
            not {tile, other} <= set(range(len(self)))
            or not {side, other_side} <= set(range(4))
            or tile == other
        ):
            raise UsageError(
                f"link {link}: tiles are 0 to {len(self) - 1}, sides 0 to 3 (N E S W), two tiles each"
            )
        _library().tilenca_array_link(self.handle, tile, side, other, other_side)

    def run(self, seconds: float) -> None:
        """Runs all tiles for a while.

        Raises:
            TilencaError: a tile stopped at a fault; the message names tile, place and fact.
        """
        if _library().tilenca_array_run(self.handle, seconds):
            raise TilencaError(next(tile.fault for tile in self._tiles if tile.fault))

    @property
    def time_s(self) -> float:
        """Seconds of emulated time since the array began, a whole number of 16 us."""
        return float(_library().tilenca_array_time(self.handle))

    def __len__(self) -> int:
        return len(self._tiles)

    def __getitem__(self, index: int) -> EmulatedTile:
        return self._tiles[index]

    def __iter__(self) -> Iterator[EmulatedTile]:
        return iter(self._tiles)

    def close(self) -> None:
        """Frees the tiles; the array cannot be used afterwards."""
        if self.handle:
            _library().tilenca_array_free(self.handle)
            self.handle = None

    def __del__(self) -> None:
        self.close()

    def __enter__(self) -> "Array":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _check(succeeded: bool) -> None:
    if not succeeded:
        raise UsageError(_library().tilenca_last_error().decode())
