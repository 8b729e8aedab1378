"""What a firmware says of itself."""

from support.avr import Compile
from support.firmware import board_test_image
from tilenca.base.paths import FIRMWARE_ELF
from tilenca.emulator.greeting import firmware_settings, greeting, is_board_test, settings_of


def test_a_firmware_greets_with_its_model_and_its_settings() -> None:
    hello = greeting(FIRMWARE_ELF)
    assert hello is not None
    assert (hello.tile, hello.classes) == (0, 11)
    settings = firmware_settings(FIRMWARE_ELF)
    assert settings == settings_of(hello)
    assert settings is not None
    assert settings.period_ms == hello.period_ms == 20


def test_a_program_that_says_nothing_has_no_settings(avr: Compile) -> None:
    assert greeting(avr("int main(void) { for (;;) { } }")) is None
    assert settings_of(None) is None


def test_the_board_test_is_told_from_a_program_that_says_nothing() -> None:
    assert is_board_test(board_test_image())
    assert not is_board_test(FIRMWARE_ELF)
