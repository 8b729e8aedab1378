"""The block of settings in EEPROM, on the cases that the C++ twin is tested with."""

import pytest

from support.vectors import cases
from tilenca.protocol.settings import Settings, marking_block, parse_settings, settings_block


@pytest.mark.parametrize(("name", "block", "expected"), cases("settings.inc"))
def test_settings_case(name: str, block: str, expected: str) -> None:
    settings = parse_settings(bytes.fromhex(block))
    if expected == "ignored":
        assert settings is None
    else:
        assert settings == Settings(*map(int, expected.split()))
        assert settings_block(*map(int, expected.split())) == bytes.fromhex(block)


@pytest.mark.parametrize(
    "values",
    [
        (256, 100, 0),
        (-1, 100, 0),
        (1, 9, 0),
        (1, 10001, 0),
        (1, 100, 65536),
        (1, 100, 0, 256),
        (1, 100, 0, 255, 3),
    ],
)
def test_settings_out_of_range_are_refused(values: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=r"must be \d+\.\.\d+"):
        settings_block(*values)


def test_a_marking_is_the_block_that_the_twin_reads() -> None:
    block = bytes.fromhex("54420202f90300000000f7eb")  # as in test/firmware/test_app/settings.cpp
    assert marking_block(2, 1017) == block
    assert parse_settings(block) is None
