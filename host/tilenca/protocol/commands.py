"""The host's commands to a tile, as sentences (docs/PROTOCOL.md section 6)."""

from tilenca.protocol.constants import MAX_BLINK_S, MAX_REVISION, MAX_SERIAL, PRESETS, SETTING_RANGES
from tilenca.protocol.sentences import framed


def ask_command() -> bytes:
    """Asks a tile for its HELLO."""
    return framed("ASK")


def chip_command() -> bytes:
    """Asks a tile for its fuse and lock bytes, and its marking."""
    return framed("CHIP")


def set_command(name: str, value: int | str) -> bytes:
    """Tells a tile to keep a setting: `id`, `period` (ms), `updates`, `brightness`, or `preset`.

    Raises:
        ValueError: there is no such setting, or the value is out of its range.
    """
    if name == "preset":
        if value not in PRESETS:
            raise ValueError(f"no preset '{value}': there are {' and '.join(PRESETS)}")
    elif name not in SETTING_RANGES:
        raise ValueError(f"no setting '{name}': there are {', '.join(SETTING_RANGES)} and preset")
    else:
        low, high = SETTING_RANGES[name]
        if not isinstance(value, int) or not low <= value <= high:
            raise ValueError(f"{name} '{value}': must be a whole number in {low}..{high}")
    return framed(f"SET,{name},{value}")


def mark_command(revision: int, serial: int, replace: bool = False) -> bytes:
    """Marks a board with its revision and serial number, for good unless told to `replace` that.

    Raises:
        ValueError: out of range.
    """
    if not 1 <= revision <= MAX_REVISION or not 0 <= serial <= MAX_SERIAL:
        raise ValueError(
            f"board '{revision}.{serial}': the revision is 1..{MAX_REVISION}, "
            f"the serial number 0..{MAX_SERIAL}"
        )
    return framed(f"MARK,{revision},{serial}{',replace' if replace else ''}")


def blink_command(seconds: int) -> bytes:
    """Lets a tile's display blink for some seconds, 0..MAX_BLINK_S; 0 ends it.

    Raises:
        ValueError: out of range.
    """
    if not 0 <= seconds <= MAX_BLINK_S:
        raise ValueError(f"blink {seconds}: must be 0..{MAX_BLINK_S} seconds")
    return framed(f"BLINK,{seconds}")


def restart_command() -> bytes:
    """Lets a tile begin again from the seed, as its button does."""
    return framed("RESTART")
