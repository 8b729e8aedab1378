"""One emulated tile, as eyes, fingers, cables and a debugger reach it."""

from array import array as packed
from collections.abc import Sequence
from typing import Any

from tilenca.base.errors import UsageError
from tilenca.emulator.home import Home, Nowhere
from tilenca.emulator.library import call, library, new, numbers, text
from tilenca.emulator.probe import PinProbe, WireTap, pin_port
from tilenca.emulator.types import DisplayChange, Mark, ResetCause, Stack

EEPROM_BYTES = 4096
RECEIVE_CHUNK = 1024
MOST_TILES = 4096
DATA_SPACE = 0x800000  # where an ELF file of AVR puts data memory


class EmulatedTile:
    """See above. Made by `Array`."""

    def __init__(self, array: Home, index: int) -> None:
        self._array = array
        self.index = index
        self._inbox = new("uint8_t[]", RECEIVE_CHUNK), new("double[]", RECEIVE_CHUNK)

    def retire(self) -> None:
        """The array it was in has gone back to before it was there."""
        self._array = Nowhere()

    @property
    def segments(self) -> int:
        """The lit segments: bit 0 = a ... bit 6 = g, bit 7 = dp, as in `tilenca.shapes.glyphs`."""
        return int(self._call("tile_segments"))

    @property
    def rgb(self) -> tuple[int, int, int]:
        """Duty of the red, green and blue LED now, 0..255 each, as the pins give it."""
        duty = new("uint8_t[3]")
        self._call("tile_rgb", duty)
        return duty[0], duty[1], duty[2]

    @property
    def leds(self) -> tuple[bool, bool, bool, bool]:
        """The four debug LEDs as eyes see them: those lit within the last 20 ms, in the order N E S W."""
        mask = self._call("tile_leds")
        return bool(mask & 1), bool(mask & 2), bool(mask & 4), bool(mask & 8)

    @property
    def display_changes(self) -> list[DisplayChange]:
        """Everything the display has shown, in order; it is dark until the first change."""
        count = self._call("tile_display_changes", 0, new("double[]", 0), new("uint8_t[]", 0), 0)
        times, segments = new("double[]", count), new("uint8_t[]", count)
        self._call("tile_display_changes", 0, times, segments, count)
        return list(map(DisplayChange, numbers(times, count), numbers(segments, count)))

    @property
    def fault(self) -> str:
        """What stopped the tile (tile, address, function, fact), or "" while it runs."""
        return text(self._call("tile_fault"))

    @property
    def warnings(self) -> list[str]:
        """Functions of the chip that the program asked for and that are not modelled, each once."""
        return [text(self._call("tile_warning", index)) for index in range(self._call("tile_warnings"))]

    @property
    def cycles(self) -> tuple[int, int]:
        """Clock cycles of the time it was switched on: in all, and asleep."""
        cycles = new("tilenca_cycles*")
        self._call("tile_cycles", cycles)
        return cycles.total - cycles.off, cycles.asleep

    @property
    def sleep_share(self) -> float:
        """Share of its time (0..1) that the tile has slept so far."""
        total, asleep = self.cycles
        return asleep / max(total, 1)

    @property
    def stack(self) -> Stack:
        """Where the stack stands, how far down it has been, and where the data end."""
        stack = new("tilenca_stack*")
        self._call("tile_stack", stack)
        return Stack(stack.pointer, stack.deepest, stack.floor)

    @property
    def pc(self) -> int:
        """Byte address in flash of the next instruction."""
        return int(self._call("tile_pc"))

    @pc.setter
    def pc(self, address: int) -> None:
        self._call("tile_set_pc", address)

    @property
    def function(self) -> str:
        """The function that the next instruction is in, or ""."""
        return self._array.function_at(self.pc)

    def press_button(self, pressed: bool = True) -> None:
        """Holds the push button down, or lets it go."""
        self._call("tile_press_button", pressed)

    def reset(self, cause: ResetCause = ResetCause.EXTERNAL) -> None:
        """Resets the chip from outside, as opening its USB serial port does, or a sagging supply."""
        self._call("tile_reset", cause)

    @property
    def powered(self) -> bool:
        """Whether it has power. Switched on again it starts as new, but for flash, EEPROM and fuses."""
        return bool(self._call("tile_is_powered"))

    @powered.setter
    def powered(self, on: bool) -> None:
        self._call("tile_set_power", on)

    def set_drift(self, ppm_per_s: float) -> None:
        """From now on the clock error grows by so many ppm a second, to 500,000 at most, every 1/15 s."""
        self._call("tile_set_drift", ppm_per_s)

    def set_skew(self, ppm: float) -> None:
        """From now on the clock is so many ppm faster than it would be, at most 100,000."""
        self._call("tile_set_skew", ppm)

    def set_fuses(self, low: int = 0xFF, high: int = 0xD9, extended: int = 0xFD, lock: int = 0xFF) -> None:
        """Sets fuse and lock bytes as a programmer does; the chip starts anew."""
        self._call("tile_set_fuses", low, high, extended, lock)

    def write_serial(self, data: bytes) -> None:
        """Queues bytes for the tile's USB serial; they arrive while the array runs, at the tile's speed."""
        self._call("tile_send", data, len(data))

    def read_serial(self) -> bytes:
        """Everything the tile has sent on its USB serial since the last read."""
        return self.read_serial_timed()[0]

    def read_serial_timed(self) -> tuple[bytes, Sequence[float]]:
        """Like `read_serial`, and for each byte the time in seconds at which it had arrived."""
        data, arrived, count = b"", packed("d"), RECEIVE_CHUNK
        while count == RECEIVE_CHUNK:
            count = self._call("tile_receive", *self._inbox, RECEIVE_CHUNK)
            data += bytes(library().ffi.buffer(self._inbox[0], count))
            arrived.frombytes(library().ffi.buffer(self._inbox[1], arrived.itemsize * count))
        return data, arrived

    def read_eeprom(self, address: int = 0, count: int = EEPROM_BYTES) -> bytes:
        """Bytes of the EEPROM. A range that ends beyond a memory is refused, here as below."""
        return self._read("tile_read_eeprom", address, count)

    def write_eeprom(self, address: int, data: bytes) -> None:
        """Puts bytes into the EEPROM at once, as a programmer does before the tile is switched on."""
        self._call("tile_write_eeprom", address, data, len(data))

    def read_memory(self, address: int, count: int) -> bytes:
        """Bytes of the data space as stored: registers from 0, I/O from 0x20, SRAM from 0x200."""
        return self._read("tile_read_memory", address, count)

    def read_flash(self, address: int, count: int) -> bytes:
        """Bytes of the program memory."""
        return self._read("tile_read_flash", address, count)

    def pin(self, port: str, bit: int) -> bool:
        """The level of a pin, such as `pin("K", 7)`."""
        return bool(self._call("tile_pin", pin_port(port), bit))

    def duty(self, port: str, bit: int) -> float:
        """Share of time (0..1) an output is high under its timer's PWM; 0 for an input."""
        return float(self._call("tile_duty", pin_port(port), bit))

    def hold_pin(self, port: str, bit: int, level: bool | None) -> None:
        """Drives an input from outside, whatever a cable does to it; with None, it lets go."""
        self._call("tile_hold_pin", pin_port(port), bit, -1 if level is None else level)

    def set_analog(self, channel: int, value: int) -> None:
        """What analog input A0 to A15 converts to, 0..1023."""
        self._call("tile_set_analog", channel, value)

    def set_supply(self, volts: float) -> None:
        """The supply, 1.8 to 5.5 V, as the ADC sees it beside the bandgap; the chip runs on at any."""
        self._call("tile_set_supply", volts)

    def set_adc_noise(self, deviation: float, seed: int = 0) -> None:
        """Conversions are off by a normal deviate, in units of the result's lowest bit."""
        self._call("tile_set_adc_noise", deviation, (seed * MOST_TILES + self.index) % 2**64)

    def set_comparator(self, ain0: int, ain1: int) -> None:
        """The voltages at AIN0 (PE2) and AIN1 (PE3), in 1024ths of the supply."""
        self._call("tile_set_comparator", ain0, ain1)

    def set_spi_loopback(self, on: bool = True) -> None:
        """Joins MOSI and MISO; without it, MISO reads as the pin PB3 does."""
        self._call("tile_set_spi_loopback", on)

    def push_edge(self, port: str, bit: int, cycle: int, level: bool) -> None:
        """Lets an input change at a future cycle of the tile's own clock; it is driven, high, from now on."""
        self._call("tile_push_edge", pin_port(port), bit, cycle, level)

    def write_memory(self, address: int, data: bytes) -> None:
        """Puts bytes into the data space as stored; peripherals do not notice."""
        self._call("tile_write_memory", address, data, len(data))

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
        self._call("tile_set_mark", self._array.code_address(place), on)

    def marks(self) -> list[Mark]:
        """The notes since the last call. Cycles between two marks are the difference of theirs."""
        places, cycles = new("uint32_t[]", RECEIVE_CHUNK), new("uint64_t[]", RECEIVE_CHUNK)
        found: list[Mark] = []
        while count := self._call("tile_marks", places, cycles, RECEIVE_CHUNK):
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
        return self.tap_pin(*self.side_pin(side, receiving), baud)

    def tap_pin(self, port: str, bit: int, baud: float = 0.0) -> WireTap:
        """Like `tap`, on any pin."""
        return WireTap(lambda: self._array.handle, self.index, port, bit, baud)

    @staticmethod
    def side_pin(side: int, receiving: bool = False) -> tuple[str, int]:
        """Port and bit of the pin that a side sends on, or receives on: ("H", 1) for the north side."""
        port, bit = new("char*"), new("unsigned*")
        call("side_pin", side, receiving, port, bit)
        return port[0].decode(), bit[0]

    # --- for debuggers; see tilenca.emulator.gdb ---

    @property
    def halted(self) -> bool:
        """Whether it stands before a breakpoint; `Array.run` returns early while any tile does."""
        return bool(self._call("tile_is_halted"))

    def set_breakpoint(self, place: str | int, on: bool = True) -> None:
        """Halts before a function, or the instruction at a byte address of flash."""
        address = self._array.code_address(place)
        self._call("tile_set_breakpoint", address, on)

    def halt(self) -> None:
        """Halts it where it stands."""
        self._call("tile_halt")

    def step(self) -> bool:
        """Executes one instruction, or enters one interrupt, and halts again; the other tiles catch up.

        Returns:
            False if it sleeps on after a second, or another tile has halted first.
        """
        return bool(self._call("tile_step"))

    def resume(self) -> None:
        """Lets a halted tile go on with the next `Array.run`."""
        self._call("tile_resume")

    @property
    def status(self) -> int:
        """SREG."""
        return int(self._call("tile_status"))

    @status.setter
    def status(self, value: int) -> None:
        self._call("tile_set_status", value)

    def _read(self, what: str, address: int, count: int) -> bytes:
        if count < 0:
            raise UsageError(f"{count} bytes cannot be read")
        buffer = new("uint8_t[]", count)
        self._call(what, address, buffer, count)
        return bytes(buffer)

    def _call(self, function: str, *arguments: Any) -> Any:
        return library().call(function, self._array.handle, self.index, *arguments)
