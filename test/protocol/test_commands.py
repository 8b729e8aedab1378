"""What the host tells a tile: the commands of the shared table, and no others."""

import pytest

from support.vectors import cases
from tilenca.protocol.commands import ask_command, blink_command, restart_command, set_command
from tilenca.protocol.constants import MAX_COMMAND

COMMANDS = {
    "ask": ask_command(),
    "set": set_command("period", 20),
    "preset": set_command("preset", "paper"),
    "blink": blink_command(60),
    "restart": restart_command(),
}


def test_commands_are_those_of_the_shared_table() -> None:
    lines = {name: bytes.fromhex(line) for name, line, _ in cases("commands.inc")}
    for name, command in COMMANDS.items():
        assert command == lines[name]


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [("id", 0, 255), ("period", 10, 10000), ("updates", 0, 65535), ("brightness", 0, 255), ("leds", 0, 2)],
)
def test_settings_have_the_ranges_of_the_protocol(name: str, low: int, high: int) -> None:
    assert set_command(name, low).startswith(b"$SET,%s,%d*" % (name.encode(), low))
    assert len(set_command(name, high)) <= MAX_COMMAND
    for value in (low - 1, high + 1, "7"):
        with pytest.raises(ValueError, match=rf"{low}\.\.{high}"):
            set_command(name, value)


def test_commands_that_no_tile_takes_are_not_built() -> None:
    with pytest.raises(ValueError, match="paper and default"):
        set_command("preset", "fast")
    with pytest.raises(ValueError, match="no setting 'color'"):
        set_command("color", 3)
    for seconds in (-1, 61):
        with pytest.raises(ValueError, match=r"0\.\.60"):
            blink_command(seconds)
