"""The plain text of the firmware that tests a board (docs/BOARD_TEST.md). Standard library only."""

import re

BOARD_TEST = "runs the board test"

# How each line of firmware/src/board_test begins; the rest is plain text.
_LINE = re.compile(
    rb"(?:board test|self-test|button|colours|display|LEDs|side [NESW]|supply|fuses|bootloader|EEPROM"
    rb"|link LEDs|pins|rate [NEW]|clock|watchdog): [ -~]+"
)


def board_test_text(raw: bytes) -> str | None:
    """The board test's text in a line; None if the line is another program's."""
    return raw.decode("ascii") if _LINE.fullmatch(raw) else None
