"""One emulated tile, as eyes, fingers, cables and a debugger reach it."""

from ctypes import byref, c_char, c_double, c_uint, c_uint8, c_uint32, c_uint64
from typing import Protocol

from tilenca.base.errors import UsageError
from tilenca.emulator.library import check, library
from tilenca.emulator.probe import PinProbe, WireTap
from tilenca.emulator.types import DisplayChange, Mark, ResetCause, Stack

EEPROM_BYTES = 4096
RECEIVE_CHUNK = 4096
MOST_TILES = 4096
# Where an ELF file of AVR puts data memory.
DATA_SPACE = 0x800000


class Home(Protocol):
    """What a tile needs of the array it is in."""

    @property
    def handle(self) -> int:
        """The array as the C library knows it."""

    def symbol(self, name: str) -> tuple[int, int]:
        """Address and size of a symbol."""

    def code_address(self, place: str | int) -> int:
        """Byte address of a function, or the number given."""

    def function_at(self, address: int) -> str:
        """The function that contains a byte of flash."""


class _Nowhere:
    """Where a tile is that an array no longer has."""

    @property
    def handle(self) -> int:
        raise UsageError("this tile came after the moment that was restored; it is no more")

    def symbol(self, name: str) -> tuple[int, int]:
        raise UsageError(f"'{name}' of a tile that is no more")

    def code_address(self, place: str | int) -> int:
        raise UsageError(f"'{place}' of a tile that is no more")

    def function_at(self, address: int) -> str:
        raise UsageError(f"0x{address:05X} of a tile that is no more")


class EmulatedTile:
    """One tile of an array, as eyes, fingers, cables and a debugger reach it. Made by `Array`."""

    def __init__(self, array: Home, index: int) -> None:
        self._array = array
        self.index = index

    def retire(self) -> None:
        """The array it was in has gone back to before it was there."""
        self._array = _Nowhere()

    @property
    def segments(self) -> int:
        """The lit segments: bit 0 = a ... bit 6 = g, bit 7 = dp, as in `tilenca.shapes.glyphs`."""
        return int(library().tilenca_tile_segments(self._array.handle, self.index))

    @property
    def rgb(self) -> tuple[int, int, int]:
        """Duty of the red, green and blue LED now, 0..255 each, as the pins give it."""
        duty = (c_uint8 * 3)()
        library().tilenca_tile_rgb(self._array.handle, self.index, duty)
        return duty[0], duty[1], duty[2]

    @property
    def leds(self) -> tuple[bool, bool, bool, bool]:
        """The four debug LEDs, in the order N E S W."""
        mask = library().tilenca_tile_leds(self._array.handle, self.index)
        return bool(mask & 1), bool(mask & 2), bool(mask & 4), bool(mask & 8)

    @property
    def display_changes(self) -> list[DisplayChange]:
        """Everything the display has shown, in order; it is dark until the first change."""
        tell = library().tilenca_tile_display_changes
        count = tell(self._array.handle, self.index, 0, None, None, 0)
        times, segments = (c_double * count)(), (c_uint8 * count)()
        tell(self._array.handle, self.index, 0, times, segments, count)
        return [DisplayChange(time, lit) for time, lit in zip(times, segments, strict=True)]

    @property
    def fault(self) -> str:
        """What stopped the tile (tile, address, function, fact), or "" while it runs."""
        return str(library().tilenca_tile_fault(self._array.handle, self.index).decode())

    @property
    def warnings(self) -> list[str]:
        """Functions of the chip that the program asked for and that are not modelled, each once."""
        found: list[str] = []
        while text := library().tilenca_tile_warning(self._array.handle, self.index, len(found)):
            found.append(text.decode())
        return found

    @property
    def cycles(self) -> tuple[int, int]:
        """Clock cycles of the time it was switched on: in all, and asleep."""
        total, asleep, off = self._cycles()
        return total - off, asleep

    def _cycles(self) -> tuple[int, int, int]:
        cycles = (c_uint64 * 3)()
        library().tilenca_tile_cycles(self._array.handle, self.index, cycles)
        return cycles[0], cycles[1], cycles[2]

    @property
    def sleep_share(self) -> float:
        """Share of its time (0..1) that the tile has slept so far."""
        total, asleep = self.cycles
        return asleep / total if total else 0.0

    @property
    def stack(self) -> Stack:
        """Where the stack stands, how far down it has been, and where the data end."""
        addresses = (c_uint * 3)()
        library().tilenca_tile_stack(self._array.handle, self.index, addresses)
        return Stack(addresses[0], addresses[1], addresses[2])

    @property
    def pc(self) -> int:
        """Byte address in flash of the next instruction."""
        return int(library().tilenca_tile_pc(self._array.handle, self.index))

    @pc.setter
    def pc(self, address: int) -> None:
        library().tilenca_tile_set_pc(self._array.handle, self.index, address)

    @property
    def function(self) -> str:
        """The function that the next instruction is in, or ""."""
        return self._array.function_at(self.pc)

    def press_button(self, pressed: bool = True) -> None:
        """Holds the push button down, or lets it go."""
        library().tilenca_tile_press_button(self._array.handle, self.index, pressed)

    def reset(self, cause: ResetCause = ResetCause.EXTERNAL) -> None:
        """Resets the chip from outside, as opening its USB serial port does, or a sagging supply."""
        library().tilenca_tile_reset(self._array.handle, self.index, cause)

    @property
    def powered(self) -> bool:
        """Whether it has power. Switched on again it starts as new, but for flash, EEPROM and fuses."""
        return bool(library().tilenca_tile_is_powered(self._array.handle, self.index))

    @powered.setter
    def powered(self, on: bool) -> None:
        library().tilenca_tile_set_power(self._array.handle, self.index, on)

    def set_drift(self, ppm_per_s: float) -> None:
        """From now on the clock error grows by so many ppm in each second, in steps of 1/15 s."""
        library().tilenca_tile_set_drift(self._array.handle, self.index, ppm_per_s)

    def set_fuses(self, low: int = 0xFF, high: int = 0xD9, extended: int = 0xFD, lock: int = 0xFF) -> None:
        """Sets fuse and lock bytes as a programmer does; the chip starts anew."""
        library().tilenca_tile_set_fuses(self._array.handle, self.index, low, high, extended, lock)

    def write_serial(self, data: bytes) -> None:
        """Queues bytes for the tile's USB serial; they arrive while the array runs, at the tile's speed."""
        library().tilenca_tile_send(self._array.handle, self.index, data, len(data))

    def read_serial(self) -> bytes:
        """Everything the tile has sent on its USB serial since the last read."""
        return bytes(byte for _, byte in self.read_serial_timed())

    def read_serial_timed(self) -> list[tuple[float, int]]:
        """Like `read_serial`, each byte with the time in seconds at which it had arrived."""
        received: list[tuple[float, int]] = []
        room = RECEIVE_CHUNK
        values, times = (c_uint8 * room)(), (c_double * room)()
        while count := library().tilenca_tile_receive(self._array.handle, self.index, values, times, room):
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
        done = library().tilenca_tile_write_eeprom(self._array.handle, self.index, address, data, len(data))
        check(done == 0)

    def read_memory(self, address: int, count: int) -> bytes:
        """Bytes of the data space as stored: registers from 0, I/O from 0x20, SRAM from 0x200."""
        return self._read("read_memory", address, count)

    def read_flash(self, address: int, count: int) -> bytes:
        """Bytes of the program memory."""
        return self._read("read_flash", address, count)

    def pin(self, port: str, bit: int) -> bool:
        """The level of a pin, such as `pin("K", 7)`."""
        level = library().tilenca_tile_pin(self._array.handle, self.index, port.encode(), bit)
        check(level >= 0)
        return bool(level)

    def duty(self, port: str, bit: int) -> float:
        """Share of time (0..1) an output is high under its timer's PWM; 0 for an input."""
        duty = library().tilenca_tile_duty(self._array.handle, self.index, port.encode(), bit)
        check(duty >= 0)
        return float(duty)

    def hold_pin(self, port: str, bit: int, level: bool) -> None:
        """Drives an input from outside; an input that nobody drives reads high."""
        check(library().tilenca_tile_hold_pin(self._array.handle, self.index, port.encode(), bit, level) == 0)

    def set_analog(self, channel: int, value: int) -> None:
        """What analog input A0 to A15 converts to, 0..1023."""
        library().tilenca_tile_set_analog(self._array.handle, self.index, channel, value)

    def set_adc_noise(self, deviation: float, seed: int = 0) -> None:
        """Conversions are off by a normal deviate, in units of the result's lowest bit."""
        seed = seed * MOST_TILES + self.index
        library().tilenca_tile_set_adc_noise(self._array.handle, self.index, deviation, seed)

    def set_comparator(self, ain0: int, ain1: int) -> None:
        """The voltages at AIN0 (PE2) and AIN1 (PE3), in 1024ths of the supply."""
        library().tilenca_tile_set_comparator(self._array.handle, self.index, ain0, ain1)

    def set_spi_loopback(self, on: bool = True) -> None:
        """Joins MOSI and MISO; without it, MISO reads as the pin PB3 does: high, if nobody holds it."""
        library().tilenca_tile_set_spi_loopback(self._array.handle, self.index, on)

    def push_edge(self, port: str, bit: int, cycle: int, level: bool) -> None:
        """Lets an input change at a future cycle of the tile's own clock; not for pins that a link drives."""
        check(
            library().tilenca_tile_push_edge(self._array.handle, self.index, port.encode(), bit, cycle, level)
            == 0
        )

    def write_memory(self, address: int, data: bytes) -> None:
        """Puts bytes into the data space as stored; peripherals do not notice."""
        check(
            library().tilenca_tile_write_memory(self._array.handle, self.index, address, data, len(data)) == 0
        )

    def variable(self, name: str) -> bytes:
        """The bytes of a global variable, by its name in the ELF file; low byte first.

        Raises:
            UsageError: no such variable in data memory.
        """
        address, size = self._array.symbol(name)
        if address < DATA_SPACE or size == 0:
            raise UsageError(f"'{name}' is no variable in SRAM; give the name of a global one")
        return self.read_memory(address - DATA_SPACE, size)

    def integer(self, name: str, signed: bool = False) -> int:
        """A global variable as a number; see `variable`."""
        return int.from_bytes(self.variable(name), "little", signed=signed)

    def mark(self, place: str | int, on: bool = True) -> None:
        """Notes every time a function, or the instruction at a byte address of flash, begins."""
        address = self._array.code_address(place)
        check(library().tilenca_tile_set_mark(self._array.handle, self.index, address, on) == 0)

    def marks(self) -> list[Mark]:
        """The notes since the last call. Cycles between two marks are the difference of theirs."""
        room = RECEIVE_CHUNK
        places, cycles = (c_uint32 * room)(), (c_uint64 * room)()
        found: list[Mark] = []
        while count := library().tilenca_tile_marks(self._array.handle, self.index, places, cycles, room):
            found += [Mark(self._array.function_at(places[i]), places[i], cycles[i]) for i in range(count)]
        return found

    def probe(self, port: str, bit: int) -> PinProbe:
        """Looks at a pin from now on: `probe("H", 1).read()` are its edges."""
        return PinProbe(lambda: self._array.handle, self.index, port, bit)

    def tap(self, side: int, baud: float = 0.0, receiving: bool = False) -> WireTap:
        """Reads the bytes on a side's wire from now on.

        Args:
            side: NORTH, EAST, SOUTH or WEST.
            baud: bits per second; 0: as the program has set the USART of that pin, if it has one.
            receiving: the wire that arrives instead of the one that leaves.
        """
        port, bit = self.side_pin(side, receiving)
        return WireTap(lambda: self._array.handle, self.index, port, bit, baud)

    def tap_pin(self, port: str, bit: int, baud: float = 0.0) -> WireTap:
        """Like `tap`, on any pin."""
        return WireTap(lambda: self._array.handle, self.index, port, bit, baud)

    @staticmethod
    def side_pin(side: int, receiving: bool = False) -> tuple[str, int]:
        """Port and bit of the pin that a side sends on, or receives on: ("H", 1) for the north side."""
        port, bit = c_char(), c_uint()
        library().tilenca_side_pin(side, receiving, byref(port), byref(bit))
        return port.value.decode(), bit.value

    # --- for debuggers; see tilenca.emulator.gdb ---

    @property
    def halted(self) -> bool:
        """Whether it stands before a breakpoint; `Array.run` returns early while any tile does."""
        return bool(library().tilenca_array_halted(self._array.handle, self.index) == self.index)

    def set_breakpoint(self, place: str | int, on: bool = True) -> None:
        """Halts before a function, or the instruction at a byte address of flash."""
        address = self._array.code_address(place)
        check(library().tilenca_tile_set_breakpoint(self._array.handle, self.index, address, on) == 0)

    def halt(self) -> None:
        """Halts it where it stands."""
        library().tilenca_tile_halt(self._array.handle, self.index)

    def step(self) -> bool:
        """Executes one instruction, or enters one interrupt; the tile is halted afterwards.

        The other tiles catch up.

        Returns:
            False if it sleeps on after a second, or another tile has halted first.
        """
        return bool(library().tilenca_tile_step(self._array.handle, self.index))

    def resume(self) -> None:
        """Lets a halted tile go on with the next `Array.run`."""
        library().tilenca_tile_resume(self._array.handle, self.index)

    @property
    def status(self) -> int:
        """SREG."""
        return int(library().tilenca_tile_status(self._array.handle, self.index))

    @status.setter
    def status(self, value: int) -> None:
        library().tilenca_tile_set_status(self._array.handle, self.index, value)

    def _read(self, what: str, address: int, count: int) -> bytes:
        buffer = (c_uint8 * count)()
        check(
            getattr(library(), f"tilenca_tile_{what}")(self._array.handle, self.index, address, buffer, count)
            == 0
        )
        return bytes(buffer)
