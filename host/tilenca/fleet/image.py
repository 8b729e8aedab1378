"""Intel HEX images, checked before anything is written to a board."""

import binascii
from dataclasses import dataclass
from pathlib import Path

from tilenca.base.errors import image_error

# The stock stk500v2 bootloader owns the last 8 KiB of the ATmega2560's 256 KiB.
APPLICATION_BYTES = 248 * 1024

# Some Mega bootloaders take three exclamation marks in the data for a call of their monitor, and hang.
POISON = b"!!!"

NO_IMAGE = "not an Intel HEX file; name the firmware.hex that `pio run` builds"

DATA, END, SEGMENT, START_SEGMENT, LINEAR, START_LINEAR = range(6)


class HexError(ValueError):
    """Not an Intel HEX file; the message begins with the line number."""


def parse_hex(text: str) -> dict[int, int]:
    """The bytes of an Intel HEX file by address.

    Raises:
        HexError: a record is malformed, has a wrong checksum, or comes twice, or the end record is missing.
    """
    memory: dict[int, int] = {}
    base = 0
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip():
            continue
        offset, kind, data = _record(number, line.strip())
        if kind == END:
            return memory
        if kind == DATA:
            start = base + offset
            if any(start + index in memory for index in range(len(data))):
                raise HexError(f"{number}: address 0x{start:X} is given twice")
            memory.update(enumerate(data, start))
        elif kind in (SEGMENT, LINEAR):
            if len(data) != 2:
                raise HexError(f"{number}: an address record of {len(data)} bytes")
            base = int.from_bytes(data, "big") << (4 if kind == SEGMENT else 16)
        elif kind not in (START_SEGMENT, START_LINEAR):
            raise HexError(f"{number}: unknown record type {kind}")
    raise HexError(f"{len(text.splitlines())}: the end record is missing; the file is truncated")


def _record(number: int, line: str) -> tuple[int, int, bytes]:
    """(address offset, type, data) of one line."""
    try:
        raw = bytes.fromhex(line[1:]) if line[0] == ":" else None
    except ValueError:
        raw = None
    if raw is None or len(line) != 1 + 2 * len(raw):
        raise HexError(f"{number}: not an Intel HEX record")
    if len(raw) < 5 or len(raw) != 5 + raw[0]:
        raise HexError(f"{number}: a record of the wrong length")
    if sum(raw) & 0xFF:
        raise HexError(f"{number}: wrong checksum")
    return int.from_bytes(raw[1:3], "big"), raw[3], raw[4:-1]


def firmware_id(memory: dict[int, int]) -> int:
    """The firmware id of a tile that runs this image: CRC-32 of its flash up to the image's last byte.

    Args:
        memory: the image, as `parse_hex` gives it; addresses without a byte are erased flash, 0xFF.
    """
    return binascii.crc32(bytes(memory.get(address, 0xFF) for address in range(max(memory, default=-1) + 1)))


@dataclass(frozen=True)
class Image:
    """An image that can be written: its file, its number of bytes, and its firmware id."""

    path: Path
    size: int
    firmware_id: int


def check_image(path: Path) -> Image:
    """Checks that an image can be written to a tile.

    Raises:
        BuildError, UsageError: there is no such file, or it is not valid, too large, empty, or holds what
            hangs a bootloader; see `image_error`.
    """
    try:
        text = path.read_text(encoding="ascii")
    except OSError as error:
        raise image_error(
            f"{path}: {error.strerror}; build it with `pio run`, or name an image with --hex"
        ) from error
    except UnicodeDecodeError as error:
        raise image_error(f"{path}: {NO_IMAGE}") from error
    if not text.lstrip().startswith(":"):
        raise image_error(f"{path}: {NO_IMAGE}")
    try:
        memory = parse_hex(text)
    except HexError as error:
        raise image_error(f"{path}:{error}; build it again with `pio run`") from error
    if not memory:
        raise image_error(f"{path}: an image without a byte; build it again with `pio run`")
    if (last := max(memory)) >= APPLICATION_BYTES:
        raise image_error(
            f"{path}: reaches address 0x{last:X}; below the Mega's bootloader there is room up to "
            f"0x{APPLICATION_BYTES - 1:X}: make the firmware smaller"
        )
    if (at := _find(memory, POISON)) is not None:
        raise image_error(
            f"{path}: the bytes '!!!' at 0x{at:X} hang some Mega bootloaders; change what holds them"
        )
    return Image(path, len(memory), firmware_id(memory))


def _find(memory: dict[int, int], wanted: bytes) -> int | None:
    """The lowest address at which `wanted` lies, or None."""
    for address, byte in sorted(memory.items()):
        if byte == wanted[0] and all(memory.get(address + i) == wanted[i] for i in range(len(wanted))):
            return address
    return None
