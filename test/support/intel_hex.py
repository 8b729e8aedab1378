"""Writes Intel HEX files."""

END = ":00000001FF\n"


def record(offset: int, kind: int, data: bytes) -> str:
    raw = bytes([len(data)]) + offset.to_bytes(2, "big") + bytes([kind]) + data
    return ":" + (raw + bytes([-sum(raw) & 0xFF])).hex().upper() + "\n"


def image(data: bytes, start: int = 0) -> str:
    """An Intel HEX file of `data` from address `start`."""
    lines = []
    for at in range(0, len(data), 16):
        address = start + at
        lines.append(record(0, 4, (address >> 16).to_bytes(2, "big")))
        lines.append(record(address & 0xFFFF, 0, data[at : at + 16]))
    return "".join(lines) + END
