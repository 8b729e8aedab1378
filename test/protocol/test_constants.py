"""The numbers of the protocol are the same in C++ and here."""

import re
from pathlib import Path

from tilenca.base import paths
from tilenca.protocol import constants as constants_of_python


def constants(headers: list[Path]) -> dict[str, int]:
    """`constexpr` integers of C++ headers whose value is a plain number, by their Python name."""
    pattern = re.compile(r"constexpr \w+ k(\w+) = (\d+);")
    found = {}
    for header in headers:
        for name, value in pattern.findall(header.read_text()):
            found[re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).upper()] = int(value)
    return found


def test_constants_of_both_twins_agree() -> None:
    folders = [paths.FIRMWARE / "include" / layer for layer in ("core", "app")]
    cpp = constants([header for folder in folders for header in folder.glob("*.h")])
    shared = {name for name in cpp if hasattr(constants_of_python, name)}
    assert shared >= {
        "PROTOCOL_VERSION", "KIND_STATE", "HEADER_SIZE", "CRC_SIZE", "MAX_CHANNELS", "MESSAGE_OFFSET",
        "MESSAGE_MAX", "SILENT_PERIODS", "MAX_SENTENCE", "LEAST_SUPPLY_MV", "MAX_COMMAND", "MAX_BLINK_S",
        "SETTINGS_SIZE", "SETTINGS_VERSION", "MIN_PERIOD_MS", "MAX_PERIOD_MS",
    }  # fmt: skip
    assert {name: cpp[name] for name in shared} == {
        name: getattr(constants_of_python, name) for name in shared
    }
