"""Emulated tiles as serial ports: a pseudo-terminal for each tile's USB, in step with the wall clock.

As on a real board, opening the port resets the tile: into its bootloader, if it has one.
"""

import fcntl
import os
import select
import termios
import time
import tty
from collections.abc import Callable
from contextlib import ExitStack, suppress
from pathlib import Path

from tilenca.base.errors import UsageError
from tilenca.base.stdio import warn
from tilenca.emulator.experiment import Emulation
from tilenca.emulator.lag import Lag
from tilenca.emulator.tile import EmulatedTile
from tilenca.emulator.types import port_name

STOCK_BOOTLOADER = Path(
    "/usr/share/arduino/hardware/arduino/avr/bootloaders/stk500v2/stk500boot_v2_mega2560.hex"
)
PSEUDO_TERMINALS = Path("/dev/pts")
STEP_S = 0.002
READ_BYTES = 4096


class ServedTile:
    """One tile's pseudo-terminal and the link that names it."""

    def __init__(self, tile: EmulatedTile, link: Path, reset_on_open: bool) -> None:
        """Creates the pseudo-terminal; raises UsageError if the link cannot be made."""
        self._tile, self._link, self._reset_on_open = tile, link, reset_on_open
        self._master, slave = os.openpty()
        tty.setraw(slave)
        self._name = os.ttyname(slave)
        # With our own end closed, poll() reports a hang-up while no program has the port open.
        os.close(slave)
        os.set_blocking(self._master, False)
        self._is_open = False
        self._baud = 115200
        self._poll = select.poll()
        self._poll.register(self._master, select.POLLIN)
        self._hang_up()
        try:
            if link.is_symlink():
                link.unlink()  # left by a run that was killed
            link.symlink_to(self._name)
        except OSError as error:
            os.close(self._master)
            raise UsageError(
                f"{link}: {error.strerror}; give --serve a directory that can be written"
            ) from error

    def exchange(self) -> bytes:
        """Passes on the bytes of both directions since the last call; returns those of the tile."""
        events = dict(self._poll.poll(0)).get(self._master, 0)
        was_open, self._is_open = self._is_open, not events & select.POLLHUP
        if self._is_open and not was_open:
            self._tile.read_serial()  # no program has the port open
            if self._reset_on_open:
                self._tile.reset()
        if was_open and not self._is_open:
            self._hang_up()
        if events & select.POLLIN:
            with suppress(OSError):  # closed between poll and read
                self._tile.write_serial(os.read(self._master, READ_BYTES))
        said = self._tile.read_serial()
        if said and self._is_open:
            with suppress(BlockingIOError):  # no program reads: the bytes are lost, as on USB
                os.write(self._master, said)
        return said

    @property
    def is_open(self) -> bool:
        """Whether anybody had the port open at the last exchange."""
        return self._is_open

    def is_spoken_to(self) -> bool:
        """Whether bytes have come for the tile, or the port was closed."""
        return bool(self._poll.poll(0))

    def _hang_up(self) -> None:
        """Sets HUPCL: it tells a program that opens the port that DTR was low, as on a real port."""
        if self._reset_on_open:
            attributes = termios.tcgetattr(self._master)
            attributes[2] |= termios.HUPCL
            termios.tcsetattr(self._master, termios.TCSANOW, attributes)

    def close(self) -> None:
        """Removes the link and the pseudo-terminal."""
        if self._link.is_symlink() and str(self._link.readlink()) == self._name:
            self._link.unlink()
        os.close(self._master)


def serve(
    emulation: Emulation,
    directory: Path,
    seconds: float | None,
    reset_on_open: bool,
    on_slice: Callable[[], None],
    lag: Lag,
) -> None:
    """Serves all tiles until `seconds` have passed on the wall clock, or for ever.

    Args:
        emulation: the tiles.
        directory: where to put the links; it is made, and removed again, if it is not there.
        seconds: for how long; None: until it is interrupted.
        reset_on_open: whether opening a port resets its tile, as DTR does on a Mega.
        on_slice: called after every few milliseconds.
        lag: adds up the time by which the tiles fall behind.

    Raises:
        UsageError: the directory cannot be used, or another run serves tiles there.
        TilencaError: a tile stopped at a fault.
    """
    created = not directory.exists()
    with ExitStack() as stack:
        try:
            directory.mkdir(parents=True, exist_ok=True)
            if created:
                stack.callback(_remove, directory)
            stack.callback(os.close, _lock(directory))
            _sweep(directory)
        except OSError as error:
            raise UsageError(
                f"{directory}: {error.strerror}; give --serve a directory that can be written"
            ) from error
        served = []
        for tile in emulation.array:
            served.append(ServedTile(tile, directory / port_name(tile.index), reset_on_open))
            stack.callback(served[-1].close)
        warn(f"serving {len(served)} tiles as {directory}/tile-*; Ctrl-C ends it")
        _keep_step(emulation, served, seconds, on_slice, lag)


def _lock(directory: Path) -> int:
    """The directory, locked for us while the descriptor is open; the system closes it however we end.

    Raises:
        UsageError: another run has it.
    """
    descriptor = os.open(directory, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        raise UsageError(
            f"{directory}: another `tilenca emulate` serves its tiles there; end it, or give --serve another"
        ) from None
    return descriptor


def _sweep(directory: Path) -> None:
    """Removes the links of a killed run: its pseudo-terminals may belong to another program by now."""
    for link in directory.glob("tile-*"):
        if link.is_symlink() and link.readlink().parent == PSEUDO_TERMINALS:
            link.unlink()


def _keep_step(
    emulation: Emulation,
    served: list[ServedTile],
    seconds: float | None,
    on_slice: Callable[[], None],
    lag: Lag,
) -> None:
    started = last = time.monotonic()
    while seconds is None or last - started < seconds:
        time.sleep(max(0.0, last + STEP_S - time.monotonic()))
        now = time.monotonic()
        emulation.pass_time(lag.take(now - last))
        last = now
        for port in served:
            port.exchange()
        on_slice()


def _remove(directory: Path) -> None:
    with suppress(OSError):  # another program has put something there
        directory.rmdir()
