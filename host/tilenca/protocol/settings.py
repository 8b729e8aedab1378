"""The block of settings that a tile keeps in EEPROM (docs/PROTOCOL.md section 5)."""

from dataclasses import dataclass

from tilenca.protocol.checksums import crc16
from tilenca.protocol.constants import (
    CRC_SIZE,
    MAX_BRIGHTNESS,
    MAX_PERIOD_MS,
    MIN_PERIOD_MS,
    SETTING_RANGES,
    SETTINGS_SIZE,
    SETTINGS_VERSION,
)

_SWAPPED = (1, 0, 2)  # `leds` as the block has it, where 0 came first, and back


@dataclass(frozen=True)
class Settings:
    """A tile's settings in EEPROM.

    Attributes:
        tile_id: 0: not set.
        updates: 0: for ever.
        leds: what the link LEDs show; 0: nothing; 1: which neighbours are alive; 2: where a tile is missing.
    """

    tile_id: int
    period_ms: int
    updates: int
    brightness: int = MAX_BRIGHTNESS
    leds: int = 1


def settings_block(
    tile_id: int, period_ms: int, updates: int, brightness: int = MAX_BRIGHTNESS, leds: int = 1
) -> bytes:
    """The block of docs/PROTOCOL.md section 5 that a tile reads from EEPROM address 0.

    Raises:
        ValueError: a value is out of range.
    """
    values = {"id": tile_id, "period": period_ms, "updates": updates, "brightness": brightness, "leds": leds}
    for name, value in values.items():
        low, high = SETTING_RANGES[name]
        if not low <= value <= high:
            raise ValueError(f"{name} {value}: must be {low}..{high}")
    body = b"TN" + bytes([SETTINGS_VERSION, tile_id])
    body += (
        period_ms.to_bytes(2, "little") + updates.to_bytes(2, "little") + bytes([brightness, _SWAPPED[leds]])
    )
    return body + crc16(body).to_bytes(CRC_SIZE, "little")


def marking_block(revision: int, serial: int) -> bytes:
    """The block that a tile reads from EEPROM address MARKING_AT."""
    body = b"TB" + bytes([SETTINGS_VERSION, revision]) + serial.to_bytes(2, "little") + bytes(4)
    return body + crc16(body).to_bytes(CRC_SIZE, "little")


def parse_settings(block: bytes) -> Settings | None:
    """The settings in a block of SETTINGS_SIZE bytes, or None if a tile would ignore it."""
    body, crc = block[:-CRC_SIZE], block[-CRC_SIZE:]
    if (
        len(block) != SETTINGS_SIZE
        or body[:3] != b"TN" + bytes([SETTINGS_VERSION])
        or body[9] >= len(_SWAPPED)
    ):
        return None
    period_ms = int.from_bytes(body[4:6], "little")
    if crc16(body) != int.from_bytes(crc, "little") or not MIN_PERIOD_MS <= period_ms <= MAX_PERIOD_MS:
        return None
    return Settings(body[3], period_ms, int.from_bytes(body[6:8], "little"), body[8], _SWAPPED[body[9]])
