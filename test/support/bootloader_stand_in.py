"""A stand-in for the Mega's stock bootloader, on a pseudo-terminal: enough of STK500v2 for the real avrdude.

It is no ATmega2560: it answers at once, keeps flash in a bytearray and misbehaves when told to. What the true
bootloader does on the emulated chip is tested elsewhere.
"""

import os
import select
import threading
import tty
from dataclasses import dataclass, field
from types import TracebackType
from typing import Self

START, TOKEN, OK = 0x1B, 0x0E, 0x00
SIGN_ON, SET_PARAMETER, GET_PARAMETER, LOAD_ADDRESS = 0x01, 0x02, 0x03, 0x06
ENTER, LEAVE, PROGRAM_FLASH, READ_FLASH = 0x10, 0x11, 0x13, 0x14
READ_FUSE, READ_LOCK, READ_SIGNATURE, SPI_MULTI = 0x18, 0x1A, 0x1B, 0x1D

MEGA_2560 = bytes([0x1E, 0x98, 0x01])
ATMEGA_328P = bytes([0x1E, 0x95, 0x0F])


@dataclass
class StandIn:
    """One board; use it as a context manager.

    Attributes:
        signature: what it says it is.
        silent: it reads and never answers.
        mute_after: it stops answering after that many pages written.
        recovers: what is wrong with it is no longer so when it is greeted after a page was written.
        gone_after: its port vanishes after that many pages written.
        decayed: address whose byte reads back wrong.
        greeting: what it says when it leaves programming, as the program that it has then.
        flash: what was written.
        pages: pages written so far.
    """

    signature: bytes = MEGA_2560
    silent: bool = False
    mute_after: int | None = None
    recovers: bool = False
    gone_after: int | None = None
    decayed: int | None = None
    greeting: bytes = b""
    flash: bytearray = field(default_factory=lambda: bytearray(b"\xff" * 0x40000))
    pages: int = 0

    def __enter__(self) -> Self:
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        self.heard = threading.Event()
        self._wake_read, self._wake_write = os.pipe()
        self._address = 0
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.write(self._wake_write, b"x")
        self._thread.join(10)
        assert not self._thread.is_alive(), "the stand-in's thread hangs"
        for descriptor in (self._wake_read, self._wake_write, *self._ends()):
            os.close(descriptor)

    def _ends(self) -> tuple[int, ...]:
        return () if self._master < 0 else (self._master, self._slave)

    def _hang_up(self) -> None:
        for descriptor in self._ends():
            os.close(descriptor)
        self._master = -1

    def _serve(self) -> None:
        buffer = b""
        while self._master >= 0:
            ready, _, _ = select.select([self._master, self._wake_read], [], [])
            if self._wake_read in ready:
                return
            buffer += os.read(self._master, 4096)
            self.heard.set()
            while (message := self._message(buffer)) is not None:
                sequence, body, buffer = message
                self._answer(sequence, body)

    @staticmethod
    def _message(buffer: bytes) -> tuple[int, bytes, bytes] | None:
        """(sequence, body, rest) of the first whole message."""
        start = buffer.find(bytes([START]))
        if start < 0 or len(buffer) < start + 5:
            return None
        end = start + 5 + int.from_bytes(buffer[start + 2 : start + 4], "big")
        if len(buffer) <= end:
            return None
        return buffer[start + 1], buffer[start + 5 : end], buffer[end + 1 :]

    def _answer(self, sequence: int, body: bytes) -> None:
        reply = self._reply(body)
        if self._master < 0 or self.silent or (self.mute_after is not None and self.pages >= self.mute_after):
            return
        message = bytes([START, sequence]) + len(reply).to_bytes(2, "big") + bytes([TOKEN]) + reply
        parity = 0
        for byte in message:
            parity ^= byte
        os.write(self._master, message + bytes([parity]))
        if body[0] == LEAVE and self.greeting:
            os.write(self._master, self.greeting)

    def _reply(self, body: bytes) -> bytes:
        command = body[0]
        head = bytes([command, OK])
        if command == SIGN_ON:
            if self.recovers and self.pages:
                self.mute_after = self.decayed = None
            return head + b"\x08AVRISP_2"
        if command == GET_PARAMETER:
            return head + b"\x02"
        if command == LOAD_ADDRESS:
            self._address = 2 * (
                int.from_bytes(body[1:5], "big") & 0x7FFFFFFF
            )  # words; the top bit is a flag
            return head
        if command == PROGRAM_FLASH:
            return head + self._program(body[10 : 10 + int.from_bytes(body[1:3], "big")])
        if command == READ_FLASH:
            return head + self._read(int.from_bytes(body[1:3], "big")) + bytes([OK])
        if command == READ_SIGNATURE:
            return head + bytes([self.signature[body[4]], OK])
        if command in (READ_FUSE, READ_LOCK):
            return head + bytes([0xFF, OK])
        if command == SPI_MULTI:
            value = self.signature[body[6]] if body[4] == 0x30 else 0xFF
            return head + bytes([0, body[4], 0, value, OK])
        assert command in (SET_PARAMETER, ENTER, LEAVE), f"avrdude sent an unknown command 0x{command:02X}"
        return head

    def _program(self, data: bytes) -> bytes:
        self.flash[self._address : self._address + len(data)] = data
        self._address += len(data)
        self.pages += 1
        if self.gone_after is not None and self.pages >= self.gone_after:
            self._hang_up()
        return b""

    def _read(self, size: int) -> bytes:
        data = bytearray(self.flash[self._address : self._address + size])
        if self.decayed is not None and self._address <= self.decayed < self._address + size:
            data[self.decayed - self._address] ^= 0x10
        self._address += size
        return bytes(data)
