"""How a tile starts: in which order, and how soon."""

import pytest

from tilenca.base.paths import FIRMWARE_ELF
from tilenca.emulator import Array
from tilenca.protocol.settings import settings_block

PCICR, DDRK = 0x68, 0x107
PIN_CHANGES_K = 1 << 2
# The four debug LEDs and the south link's sending pin.
OUTPUTS_OF_K = 0x8F
STEP_S = 16e-6
MOST_S = 1.0


def started(eeprom: bytes) -> float:
    """When a tile with this EEPROM has begun to greet the host."""
    with Array(FIRMWARE_ELF) as array:
        array[0].write_eeprom(0, eeprom)
        while array.time_s < MOST_S and not array[0].read_serial():
            array.run(STEP_S)
        return array.time_s


def test_port_k_has_all_its_outputs_before_an_interrupt_uses_it() -> None:
    with Array(FIRMWARE_ELF) as array:
        while array.time_s < MOST_S and not array[0].read_memory(PCICR, 1)[0] & PIN_CHANGES_K:
            array.run(STEP_S)
        assert array[0].read_memory(PCICR, 1)[0] & PIN_CHANGES_K
        assert array[0].read_memory(DDRK, 1)[0] == OUTPUTS_OF_K


def test_a_tile_that_has_to_mend_its_settings_starts_as_soon_as_any() -> None:
    whole = settings_block(7, 100, 0)
    torn = bytes([~byte & 0xFF for byte in whole])
    assert started(torn + whole) == pytest.approx(started(whole * 2), abs=0.001)
