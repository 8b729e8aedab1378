"""Reads many serial ports at once, and goes on when one vanishes and comes back."""

import os
import selectors
import termios
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from types import TracebackType
from typing import Self

import serial

from tilenca.fleet.lock import PortBusyError, holders, port_lock
from tilenca.fleet.ports import denial, is_device
from tilenca.fleet.state import Event, PortNews
from tilenca.protocol.constants import HOST_BAUD
from tilenca.protocol.line_reader import Heard, LineReader

RETRY_S = 0.5
WRITE_S = 1.0
WAS_RESET = "opening it has reset the tile"


class _OpenPort:
    """An open port, and the part of its current line that was read."""

    def __init__(self, name: str, user: str, holder: str | None) -> None:
        """Opens it exclusively, unless `holder` has it open; others see that `user` has it.

        Raises:
            PortBusyError: another tilenca command or the holder has it.
            OSError: it cannot be opened (pyserial's errors are OSErrors).
        """
        self.name = name
        self.lines = LineReader()
        self._resources = ExitStack()
        with self._resources:
            # For our own commands the lock tells more than the process.
            self._resources.enter_context(port_lock(name, user))
            if holder:
                raise PortBusyError(holder)
            device = serial.Serial(name, HOST_BAUD, timeout=0, write_timeout=WRITE_S, exclusive=True)
            self._resources.callback(device.close)
            self._device = device
            self.descriptor: int = device.fileno()
            self.was_reset = _keep_dtr(self.descriptor)
            self._resources = self._resources.pop_all()

    def write(self, data: bytes) -> None:
        """Writes all of it; raises OSError if the port is gone or takes nothing."""
        self._device.write(data)

    def close(self) -> None:
        """Gives the port back."""
        self._resources.close()


def _keep_dtr(descriptor: int) -> bool:
    """Leaves DTR as it is when the port is closed; returns whether opening it has raised it.

    A Mega resets when DTR rises, and Linux raises DTR at every opening. A program can only avoid lowering it
    when it closes the port: then only the first opening since the cable was connected resets the board.
    HUPCL, the flag that makes the system lower DTR, shows whether DTR was left high.
    """
    attributes = termios.tcgetattr(descriptor)
    lowers = bool(attributes[2] & termios.HUPCL)
    attributes[2] &= ~termios.HUPCL
    termios.tcsetattr(descriptor, termios.TCSANOW, attributes)
    return lowers


class PortReader:
    """Turns ports into events; use it as a context manager."""

    def __init__(
        self, names: Sequence[str], clock: Callable[[], float] = time.time, user: str = "tilenca monitor"
    ) -> None:
        """Prepares to read the ports at `names`.

        Args:
            names: the ports.
            clock: gives the events' times in seconds since 1970.
            user: the command's name for others that want a port.
        """
        self._clock, self._user = clock, user
        self._selector = selectors.DefaultSelector()
        self._open: dict[str, _OpenPort] = {}
        self._closed: dict[str, str | None] = dict.fromkeys(names)  # the reason; None: not tried yet
        self._retry_s = 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for port in self._open.values():
            port.close()
        self._selector.close()

    @property
    def open(self) -> list[str]:
        """The ports that can be read now."""
        return list(self._open)

    @property
    def closed(self) -> list[str]:
        """The ports that cannot be read now."""
        return list(self._closed)

    def add(self, names: Sequence[str]) -> None:
        """Reads these ports, too."""
        self._closed |= dict.fromkeys(name for name in names if name not in {*self._open, *self._closed})

    def write(self, name: str, data: bytes) -> bool:
        """Sends bytes to the tile behind an open port; False if they were not written."""
        try:
            self._open[name].write(data)
        except (KeyError, OSError):  # a port that has gone is noticed when it is read
            return False
        return True

    def poll(self, timeout_s: float) -> list[Event]:
        """Waits at most `timeout_s` for events; returns them."""
        events: list[Event] = []
        if self._closed:
            if time.monotonic() >= self._retry_s:
                events += self._open_closed()
                self._retry_s = time.monotonic() + RETRY_S
            timeout_s = min(timeout_s, max(self._retry_s - time.monotonic(), 0.0))
        for key, _ in self._selector.select(0.0 if events else timeout_s):
            events += self._read(key.data)
        return events

    def _open_closed(self) -> list[Event]:
        there = [name for name in self._closed if is_device(name)]
        held = holders(there) if there else {}
        events: list[Event] = []
        for name, before in list(self._closed.items()):
            reason = self._try_open(name, held.get(name))
            if reason is None:
                del self._closed[name]
                note = WAS_RESET if self._open[name].was_reset else ""
                events.append(PortNews(self._clock(), name, is_open=True, reason=note))
            elif reason != before:
                self._closed[name] = reason
                events.append(PortNews(self._clock(), name, is_open=False, reason=reason))
        return events

    def _try_open(self, name: str, holder: str | None) -> str | None:
        """Opens a port; returns the reason if it cannot be opened, else None."""
        if not is_device(name):
            return "no such port; waiting for it"
        if reason := denial(name):
            return reason
        try:
            port = _OpenPort(name, self._user, holder)
        except PortBusyError as busy:
            return f"busy: {busy} has it open; waiting for it"
        except (OSError, termios.error) as error:
            return f"cannot be opened ({error}); waiting for it"
        self._open[name] = port
        self._selector.register(port.descriptor, selectors.EVENT_READ, port)
        return None

    def _read(self, port: _OpenPort) -> list[Event]:
        try:
            data = os.read(port.descriptor, 65536)
        except BlockingIOError:
            return []
        except OSError:
            data = b""
        now_s = self._clock()
        if data:
            return [Heard(now_s, port.name, raw, sentence) for raw, sentence in port.lines.feed(data)]
        # Readable and yet empty: the other end is gone.
        self._selector.unregister(port.descriptor)
        self._open.pop(port.name).close()
        self._closed[port.name] = reason = "went away; waiting for it to come back"
        return [PortNews(now_s, port.name, is_open=False, reason=reason)]
