"""Serial ports that may have a tile: found on USB or named by globs, and checked for access.

One board is one character device, even with several names, so that no two programs start on it.
"""

import glob
import grp
import os
import re
import stat
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from serial.tools.list_ports import comports
from serial.tools.list_ports_common import ListPortInfo

from tilenca.base.errors import NoDeviceError, TilencaError


@dataclass(frozen=True)
class Adapter:
    """The meaning of a pair of USB ids: `certain` if it can only be a Mega 2560."""

    name: str
    certain: bool


# Arduino's own ids name the board; a generic serial chip may sit on anything.
ADAPTERS: dict[tuple[int, int], Adapter] = {
    (0x2341, 0x0010): Adapter("Arduino Mega 2560", certain=True),
    (0x2341, 0x0042): Adapter("Arduino Mega 2560 R3", certain=True),
    (0x2341, 0x0210): Adapter("Arduino Mega 2560", certain=True),
    (0x2341, 0x0242): Adapter("Arduino Mega 2560 R3", certain=True),
    (0x2A03, 0x0010): Adapter("Arduino.org Mega 2560", certain=True),
    (0x2A03, 0x0042): Adapter("Arduino.org Mega 2560 R3", certain=True),
    (0x1A86, 0x7523): Adapter("CH340 adapter", certain=False),
    (0x1A86, 0x55D4): Adapter("CH9102 adapter", certain=False),
    (0x0403, 0x6001): Adapter("FTDI FT232R adapter", certain=False),
    (0x0403, 0x6015): Adapter("FTDI FT231X adapter", certain=False),
}

# pyserial raises when a board is unplugged during the listing.
LOOKS, LOOK_AGAIN_S = 5, 0.1

# The major number of /dev/null, /dev/zero and their like.
MEMORY = 1

MAGIC = re.compile(r"[*?[]")


@dataclass(frozen=True)
class Port:
    """A serial port.

    Attributes:
        name: path of the device as it was found or named.
        vid: USB vendor id; None for what is not on USB, such as a pseudo-terminal.
        pid: USB product id, likewise.
        serial_number: of the USB adapter; None if it has none. Clones may share one.
        location: its USB socket by the kernel's name (`1-2.3`); None if it is not on USB.
        about: a description for people.
        present: False for a port that was named but is not there.
    """

    name: str
    vid: int | None = None
    pid: int | None = None
    serial_number: str | None = None
    location: str | None = None
    about: str = ""
    present: bool = True


def natural_key(text: str) -> list[tuple[int, str]]:
    """Sort key that puts ttyACM2 before ttyACM10."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", text)]


def serial_ports() -> list[ListPortInfo]:
    """All ports of this machine, as pyserial lists them.

    Raises:
        TilencaError: it cannot, not even after a while.
    """
    for _ in range(LOOKS):
        try:
            return list(comports())
        except TypeError:
            time.sleep(LOOK_AGAIN_S)
    raise TilencaError("a board on USB does not identify itself; pull its cable and plug it in again")


def describe(info: ListPortInfo) -> Port:
    """A port from pyserial's description."""
    adapter = ADAPTERS.get((info.vid, info.pid))
    if adapter is None:
        about = _printable(info.product or info.description or "")
        about = "" if about == "n/a" else about
    else:
        about = adapter.name if adapter.certain else f"{adapter.name}, maybe a Mega 2560"
    # Neither an empty nor a blank serial number identifies a board.
    serial_number = _printable((info.serial_number or "").strip()) or None
    return Port(info.device, info.vid, info.pid, serial_number, info.location or None, about)


def _printable(text: str) -> str:
    """A board's own description goes to terminals and into files, and some contain control characters."""
    return "".join(character if character.isprintable() else "?" for character in text)


def is_mega(port: Port) -> bool:
    """Whether its USB ids are those of a Mega 2560, or of a chip that its clones have."""
    return (port.vid, port.pid) in ADAPTERS


def megas(infos: Iterable[ListPortInfo]) -> list[Port]:
    """The ports among `infos` that are, or may be, Mega 2560s, in natural order of their names."""
    found = filter(is_mega, map(describe, infos))
    return sorted(found, key=lambda port: natural_key(port.name))


def find_ports(patterns: Sequence[str] = ()) -> list[Port]:
    """The ports that `--port` names, or without any the Mega 2560s on USB.

    A pattern matches character devices by path (links to them too); a name without wildcards that is not
    there is returned with `present` False, so that one missing board is reported and does not stop the
    others.

    Raises:
        NoDeviceError: nothing was found.
    """
    infos = serial_ports()
    if not patterns:
        if found := megas(infos):
            return found
        raise NoDeviceError(
            "no Mega 2560 found on USB; connect a tile's USB cable, or name ports with --port '/dev/ttyACM*' "
            "(emulated tiles: tilenca emulate --serve DIR, then --port 'DIR/*')"
        )
    by_device = {os.path.realpath(info.device): describe(info) for info in infos}
    found = _named(patterns, by_device)
    if not any(port.present for port in found):
        raise NoDeviceError(
            f"no serial port matches {' '.join(patterns)}; `tilenca devices` lists what is on USB"
        )
    return found


def _named(patterns: Sequence[str], by_device: dict[str, Port]) -> list[Port]:
    ports: dict[str, Port] = {}
    for pattern in patterns:
        literal = os.path.lexists(pattern) or not MAGIC.search(pattern)
        # Path.glob refuses absolute patterns.
        names = [pattern] if literal else sorted(glob.glob(pattern), key=natural_key)  # noqa: PTH207
        for name in names:
            device = os.path.realpath(name)
            known = by_device.get(device, Port(name))
            if is_device(name):
                ports.setdefault(device, replace(known, name=name, about=known.about or nature(device)))
            elif literal:
                about = "not a serial port" if Path(name).exists() else "no such port"
                ports.setdefault(device, Port(name, about=about, present=False))
    return sorted(ports.values(), key=lambda port: natural_key(port.name))


def nature(device: str) -> str:
    """The description, for people, of a device (a resolved path) that is not on USB."""
    return "pseudo-terminal" if is_pty(device) else ""


def is_device(name: str) -> bool:
    """Whether `name` is a character device now, other than /dev/null and its like."""
    try:
        about = Path(name).stat()
    except OSError:
        return False
    return stat.S_ISCHR(about.st_mode) and os.major(about.st_rdev) != MEMORY


def is_pty(device: str) -> bool:
    """Whether a resolved path is a pseudo-terminal."""
    return device.startswith("/dev/pts/")


def denial(name: str) -> str | None:
    """The reason why this user may not use a port, with the remedy; None if they may."""
    if os.access(name, os.R_OK | os.W_OK):
        return None
    if is_pty(os.path.realpath(name)):
        return "permission denied; these emulated tiles are another user's: serve your own"
    try:
        group = grp.getgrgid(Path(name).stat().st_gid).gr_name
    except (OSError, KeyError):
        group = "dialout"
    group = "dialout" if group == "root" else group
    return f"permission denied; join its group with `sudo usermod -aG {group} $USER`, then log in again"
