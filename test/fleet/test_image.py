"""Intel HEX: what is an image, and which images are never written."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from support.intel_hex import END, image, record
from tilenca.base import paths
from tilenca.base.errors import BuildError, TilencaError, UsageError
from tilenca.fleet.image import APPLICATION_BYTES, HexError, check_image, firmware_id, parse_hex


@given(st.binary(max_size=300), st.integers(0, 0x3F00).map(lambda block: block * 16))
def test_what_is_written_is_read_back(data: bytes, start: int) -> None:
    assert parse_hex(image(data, start)) == dict(enumerate(data, start))


@given(st.text(alphabet=":0123456789ABCDEFabcdef\n\rg ", max_size=200) | st.text(max_size=100))
def test_any_text_is_an_image_or_a_hex_error(text: str) -> None:
    try:
        memory = parse_hex(text)
    except HexError:
        return
    assert all(0 <= byte <= 255 for byte in memory.values())


def test_segment_addresses_are_in_units_of_16() -> None:
    assert parse_hex(record(0, 2, b"\x10\x00") + record(2, 0, b"x") + END) == {0x10002: ord("x")}


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (image(b"abc").replace(END, ""), "truncated"),
        (image(b"abc").replace("61", "62"), ":2: wrong checksum"),
        (record(0, 0, b"ab") + record(1, 0, b"c") + END, ":2: address 0x1 is given twice"),
        (record(0, 9, b"") + END, ":1: unknown record type 9"),
        ("\x7fELF\n", ": not an Intel HEX file; name the firmware.hex that `pio run` builds"),
        ("# tilenca\n", ": not an Intel HEX file"),
        ("", ": not an Intel HEX file"),
        (":0\n", ":1: not an Intel HEX record"),
        (":0000\n", ":1: a record of the wrong length"),
        (END, "without a byte"),
        (image(b"x" * 16, APPLICATION_BYTES - 8), "reaches address 0x3E007"),
        (image(b"Hello" + b"!" * 3), "'!!!' at 0x5"),
        (image(b"13 bytes and !!!"), "'!!!' at 0xD"),
        (image(b"fifteen bytes!!" + b"!"), "'!!!' at 0xD"),
    ],
)
def test_a_bad_image_is_refused_with_place_and_fact(text: str, complaint: str, tmp_path: Path) -> None:
    path = tmp_path / "firmware.hex"
    path.write_text(text)
    with pytest.raises(UsageError) as caught:
        check_image(path)
    assert str(caught.value).startswith(str(path))
    assert complaint in str(caught.value)


def test_three_marks_across_two_records_are_found(tmp_path: Path) -> None:
    path = tmp_path / "firmware.hex"
    path.write_text(image(b"x" * 14 + b"!!" + b"!" + b"y" * 9))
    with pytest.raises(UsageError, match="'!!!' at 0xE"):
        check_image(path)


def test_an_image_up_to_the_bootloader_is_accepted(tmp_path: Path) -> None:
    path = tmp_path / "firmware.hex"
    path.write_text(image(b"!!" + b"x" * 14, APPLICATION_BYTES - 16))
    assert check_image(path).size == 16


def test_a_missing_image_is_a_usage_error_if_given_and_a_build_error_if_ours(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="--hex"):
        check_image(tmp_path / "none.hex")
    with pytest.raises(BuildError, match="pio run"):
        check_image(paths.FIRMWARE_ELF.with_name("none.hex"))


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", None])
def test_what_cannot_be_read_as_text_is_refused(content: bytes | None, tmp_path: Path) -> None:
    path = tmp_path
    if content is not None:
        path = tmp_path / "binary"
        path.write_bytes(content)
    with pytest.raises(TilencaError, match=r"--hex|firmware\.hex"):
        check_image(path)


def test_a_firmware_id_is_the_crc_of_the_flash_up_to_the_last_byte() -> None:
    assert firmware_id(parse_hex(image(b"123456789"))) == 0xCBF43926  # published with the polynomial
    assert firmware_id({0: ord("1"), 2: ord("3")}) == firmware_id(dict(enumerate(b"1\xff3")))
    assert firmware_id({}) == 0
