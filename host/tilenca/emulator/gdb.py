"""A GDB remote port for an emulated tile: `avr-gdb firmware.elf -ex "target remote :3333"`.

A tile that is halted halts all: they live in the same time.
"""

import select
import socket
from collections.abc import Callable
from contextlib import suppress

from tilenca.base.errors import TilencaError, UsageError
from tilenca.emulator.array import Array
from tilenca.emulator.tile import DATA_SPACE, EmulatedTile
from tilenca.emulator.types import SRAM_END

FLASH_END, EEPROM_SPACE, EEPROM_END = 0x40000, 0x810000, 0x811000
REGISTERS = 32
STACK_POINTER = 0x5D
INTERRUPT = 0x03
TRAP, ILLEGAL, INTERRUPTED = 5, 4, 2  # signals, as GDB counts them
SLICE_S = 0.005
WAIT_S = 0.2
READ_BYTES = 4096
MOST_BYTES = 1024  # of memory in one answer


class GdbPort:
    """Listens for a debugger of one tile and serves its requests."""

    def __init__(self, array: Array, tile: EmulatedTile, port: int = 0, host: str = "127.0.0.1") -> None:
        """Opens the port; 0 takes any free one.

        Raises:
            UsageError: the port cannot be opened.
        """
        self._array, self._tile = array, tile
        self._listener = socket.socket()
        self._listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            self._listener.bind((host, port))
        except (OSError, OverflowError) as error:
            self._listener.close()
            raise UsageError(f"port {port}: {error}; give another, or leave it out") from error
        self._listener.listen(1)
        self.port: int = self._listener.getsockname()[1]
        self._connection: socket.socket | None = None
        self._received = b""
        self._breakpoints: set[int] = set()
        self._goes = False

    @property
    def connected(self) -> bool:
        """Whether a debugger is connected."""
        return self._connection is not None

    @property
    def goes(self) -> bool:
        """Whether the debugger has let the tile go on."""
        return self._goes

    def wait(self, stopped: Callable[[], bool] = lambda: False) -> None:
        """Waits until a debugger is connected.

        Args:
            stopped: called at intervals; True ends the waiting with KeyboardInterrupt.
        """
        while not self.connected:
            if stopped():
                raise KeyboardInterrupt
            self.serve(timeout_s=WAIT_S)

    def serve(self, timeout_s: float = 0.0) -> None:
        """Serves the debugger's pending requests, or tells it that the tile has halted.

        Args:
            timeout_s: how long to wait for it.
        """
        if self._connection is None:
            if select.select([self._listener], [], [], timeout_s)[0]:
                self._accept()
            return
        if self._goes and (self._tile.halted or self._tile.fault):
            self._stopped(ILLEGAL if self._tile.fault else TRAP)
        if select.select([self._connection], [], [], timeout_s)[0]:
            try:
                data = self._connection.recv(READ_BYTES)
            except OSError:
                data = b""
            if not data:
                self._leave()
                return
            self._received += data
            self._take_packets()

    def run(self, seconds: float) -> None:
        """Runs the array for as long, and serves the debugger meanwhile; halted time does not count.

        Raises:
            TilencaError: a tile stopped at a fault, and no debugger was connected.
        """
        end_s = self._array.time_s + seconds
        while self._array.time_s < end_s:
            if self.connected and not self._goes:
                self.serve(timeout_s=1.0)
                continue
            self.serve()
            try:
                self._array.run(min(SLICE_S, end_s - self._array.time_s))
            except TilencaError:
                if not self.connected or not self._tile.fault:
                    raise

    def close(self) -> None:
        """Lets the tile go on and closes the port."""
        self._leave()
        self._listener.close()

    def _accept(self) -> None:
        self._connection, _ = self._listener.accept()
        self._connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._received, self._goes = b"", False
        self._tile.halt()

    def _leave(self) -> None:
        if self._connection is None:
            return
        for address in self._breakpoints:
            self._tile.set_breakpoint(address, False)
        self._breakpoints.clear()
        self._tile.resume()
        self._connection.close()
        self._connection, self._goes = None, False

    # --- packets ---

    def _take_packets(self) -> None:
        while self._received and self._connection is not None:
            if self._received[0] == INTERRUPT:
                self._received = self._received[1:]
                if self._goes:
                    self._tile.halt()
                    self._stopped(INTERRUPTED)
                continue
            start = self._received.find(b"$")
            end = self._received.find(b"#", start)
            if start < 0:
                self._received = b""  # acknowledgements
                return
            if end < 0 or len(self._received) < end + 3:
                return
            body, check = self._received[start + 1 : end], self._received[end + 1 : end + 3]
            self._received = self._received[end + 3 :]
            try:
                sound = int(check, 16) == sum(body) % 256
            except ValueError:
                sound = False
            self._write(b"+" if sound else b"-")
            if sound:
                self._obey(body.decode("latin-1"))

    def _write(self, data: bytes) -> None:
        if self._connection is not None:
            with suppress(OSError):  # it has gone; the next read will tell
                self._connection.sendall(data)

    def _answer(self, text: str) -> None:
        self._write(f"${text}#{sum(text.encode('latin-1')) % 256:02x}".encode("latin-1"))

    def _stopped(self, signal: int) -> None:
        self._goes = False
        if self._tile.fault:
            self._answer("O" + (self._tile.fault + "\n").encode().hex())
        self._tile.halt()
        self._answer(f"S{signal:02x}")

    def _obey(self, packet: str) -> None:
        command, rest = packet[:1], packet[1:]
        try:
            if command in "cs":
                self._go(rest, step=command == "s")
            elif command in "kD":
                if command == "D":
                    self._answer("OK")
                self._leave()
            else:
                self._answer(self._reply(command, rest))
        except (ValueError, IndexError, UsageError):
            self._answer("E01")

    def _go(self, address: str, step: bool) -> None:
        if address:
            self._tile.pc = int(address, 16)
        if step:
            self._tile.step()
            self._stopped(ILLEGAL if self._tile.fault else TRAP)
        else:
            self._tile.resume()
            self._goes = True

    def _reply(self, command: str, rest: str) -> str:
        match command:
            case "?":
                return f"S{TRAP:02x}"
            case "g":
                return "".join(self._register(number).hex() for number in range(REGISTERS + 3))
            case "G":
                data = bytes.fromhex(rest)
                self._set_registers(data)
                return "OK"
            case "p":
                return self._register(int(rest, 16)).hex()
            case "P":
                number, _, value = rest.partition("=")
                self._set_register(int(number, 16), bytes.fromhex(value))
                return "OK"
            case "m":
                address, _, count = rest.partition(",")
                return self._read(int(address, 16), min(int(count, 16), MOST_BYTES)).hex()
            case "M":
                place, _, data_text = rest.partition(":")
                self._put(int(place.partition(",")[0], 16), bytes.fromhex(data_text))
                return "OK"
            case "Z" | "z":
                return self._breakpoint(rest, command == "Z")
            case "H" | "T":
                return "OK"
            case "q":
                return self._query(rest)
            case _:
                return ""  # not known, as the protocol has it

    def _query(self, rest: str) -> str:
        if rest.startswith("Supported"):
            return f"PacketSize={2 * MOST_BYTES + 16:x}"
        if rest.startswith("Attached"):
            return "1"
        if rest.startswith("Rcmd,"):
            if bytes.fromhex(rest[5:]).strip() != b"reset":
                return b"the only command is: monitor reset\n".hex()
            self._tile.reset()
            return "OK"
        return ""

    def _breakpoint(self, rest: str, insert: bool) -> str:
        kind, address_text, _ = rest.split(",", 2)
        if kind not in "01":
            return ""
        address = int(address_text, 16)
        self._tile.set_breakpoint(address, insert)
        (self._breakpoints.add if insert else self._breakpoints.discard)(address)
        return "OK"

    # --- registers and memory ---

    def _register(self, number: int) -> bytes:
        """R0 to R31, then SREG, SP in two bytes, PC in four: as avr-gdb numbers them."""
        if number < REGISTERS:
            return self._tile.read_memory(number, 1)
        return {
            REGISTERS: bytes([self._tile.status]),
            REGISTERS + 1: self._tile.read_memory(STACK_POINTER, 2),
            REGISTERS + 2: self._tile.pc.to_bytes(4, "little"),
        }.get(number, b"\0")

    def _set_register(self, number: int, value: bytes) -> None:
        if number < REGISTERS:
            self._tile.write_memory(number, value[:1])
        elif number == REGISTERS:
            self._tile.status = value[0]
        elif number == REGISTERS + 1:
            self._tile.write_memory(STACK_POINTER, value[:2])
        elif number == REGISTERS + 2:
            self._tile.pc = int.from_bytes(value[:4], "little")

    def _set_registers(self, data: bytes) -> None:
        for number in range(REGISTERS):
            self._set_register(number, data[number : number + 1])
        for number, start in ((REGISTERS, 32), (REGISTERS + 1, 33), (REGISTERS + 2, 35)):
            self._set_register(number, data[start : start + 4])

    def _read(self, address: int, count: int) -> bytes:
        if address >= EEPROM_SPACE:
            return self._tile.read_eeprom(address - EEPROM_SPACE, min(count, EEPROM_END - address))
        if address >= DATA_SPACE:
            start = address - DATA_SPACE
            return self._tile.read_memory(start, max(0, min(count, SRAM_END - start)))
        return self._tile.read_flash(address, max(0, min(count, FLASH_END - address)))

    def _put(self, address: int, data: bytes) -> None:
        if address >= EEPROM_SPACE:
            self._tile.write_eeprom(address - EEPROM_SPACE, data)
        elif address >= DATA_SPACE:
            self._tile.write_memory(address - DATA_SPACE, data)
        else:
            raise UsageError("flash is the image's; build it anew, or program it through its bootloader")
