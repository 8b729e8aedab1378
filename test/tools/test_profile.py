"""The account of a tile's time is made of a firmware that the profiler builds for itself."""

from firmware import profile


def test_the_firmware_is_built_with_the_script_that_keeps_line_numbers() -> None:
    text = profile.EXTRA_SCRIPT.read_text(encoding="utf-8")
    assert "-g" in text
