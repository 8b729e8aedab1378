"""The checksums of the protocol: CRC-16 of frames and settings, XOR of sentences (docs/PROTOCOL.md)."""

import binascii
from functools import reduce
from operator import xor


def crc16(data: bytes) -> int:
    """CRC-16/IBM-3740 of `data`; of b"123456789" it is 0x29B1."""
    return binascii.crc_hqx(data, 0xFFFF)


def checksum(body: bytes) -> int:
    """XOR of all bytes between `$` and `*`."""
    return reduce(xor, body, 0)
