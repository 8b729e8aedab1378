"""The checksums are the published ones."""

from tilenca.protocol.checksums import checksum, crc16


def test_crc_of_123456789_is_the_published_one() -> None:
    assert crc16(b"123456789") == 0x29B1
    assert crc16(b"") == 0xFFFF


def test_a_sentences_checksum_is_the_xor_of_its_bytes() -> None:
    assert checksum(b"") == 0
    assert checksum(b"A") == 0x41
    assert checksum(b"ASK") == 0x41 ^ 0x53 ^ 0x4B
    assert checksum(b"AA") == 0
