"""PlatformIO's description of a board, made from the boards.txt of an Arduino core."""

from collections.abc import Mapping
from typing import Any


def parse_boards(text: str) -> dict[str, str]:
    """The `key=value` lines of a boards.txt; comments and blank lines are left out."""
    lines = (line.strip() for line in text.splitlines())
    pairs = (line.split("=", 1) for line in lines if "=" in line and not line.startswith("#"))
    return {key.strip(): value.strip() for key, value in pairs}


def board_manifest(properties: Mapping[str, str], board: str, cpu: str) -> dict[str, Any]:
    """The content of PlatformIO's JSON file of a board.

    Args:
        properties: all of boards.txt.
        board: the board's key there, as `mega`.
        cpu: the choice in its menu of processors, as `atmega2560`; it overrides the board's own values.

    Raises:
        KeyError: boards.txt lacks the board or a value that is needed.
    """
    own = _below(properties, board)
    own.update(_below(own, f"menu.cpu.{cpu}"))
    ids = sorted({(key.split(".")[1]) for key in own if key.startswith("vid.")}, key=int)
    return {
        "name": own["name"],
        "vendor": "Arduino",
        "url": "https://www.arduino.cc",
        "frameworks": ["arduino"],
        "build": {
            "core": own["build.core"],
            "extra_flags": f"-DARDUINO_{own['build.board']}",
            "f_cpu": own["build.f_cpu"],
            "hwids": [[own[f"vid.{index}"], own[f"pid.{index}"]] for index in ids],
            "mcu": own["build.mcu"],
            "variant": own["build.variant"],
        },
        "upload": {
            "maximum_ram_size": int(own["upload.maximum_data_size"]),
            "maximum_size": int(own["upload.maximum_size"]),
            "protocol": own["upload.protocol"],
            "require_upload_port": True,
            "speed": int(own["upload.speed"]),
        },
    }


def _below(properties: Mapping[str, str], prefix: str) -> dict[str, str]:
    start = prefix + "."
    return {key.removeprefix(start): value for key, value in properties.items() if key.startswith(start)}
