"""What a firmware image says of itself when a tile starts with it."""

from pathlib import Path

from tilenca.base.errors import image_error
from tilenca.emulator.array import Array
from tilenca.protocol.board_test import board_test_text
from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.sentences import HelloSentence, OtherVersionSentence
from tilenca.protocol.settings import Settings

SLICE_S = 0.05
HELLO_S = 1.0  # the longest time until a firmware greets; it usually takes milliseconds


def greeting(elf: Path) -> HelloSentence | None:
    """The greeting of a firmware with an empty EEPROM, as one tile sends it; None if it does not greet.

    Raises:
        BuildError, UsageError: the image cannot be used or speaks another version of the protocol, or the
            emulator is not built.
        TilencaError: the firmware stopped at a fault.
    """
    reader = LineReader()
    with Array(elf) as array:
        while array.time_s < HELLO_S:
            array.run(SLICE_S)
            for _, sentence in reader.feed(array[0].read_serial()):
                if isinstance(sentence, OtherVersionSentence):
                    raise image_error(f"{elf}: {sentence.remedy}")
                if isinstance(sentence, HelloSentence):
                    return sentence
    return None


def is_board_test(elf: Path) -> bool:
    """Whether an image that does not greet is that of docs/BOARD_TEST.md, by what it says."""
    with Array(elf) as array:
        array.run(HELLO_S)
        return any(board_test_text(line) for line in array[0].read_serial().splitlines())


def settings_of(hello: HelloSentence | None) -> Settings | None:
    """The settings that a firmware greets with; None if it does not greet."""
    if hello is None:
        return None
    return Settings(hello.tile, hello.period_ms, hello.updates, hello.brightness)


def firmware_settings(elf: Path) -> Settings | None:
    """The settings of a firmware with an empty EEPROM; see `greeting`."""
    return settings_of(greeting(elf))
