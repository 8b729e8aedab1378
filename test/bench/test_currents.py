"""What a tile draws: the page has what is computed, and the limits hold."""

from bench import currents
from bench.publish import written
from tilenca.base.paths import ROOT


def test_the_page_has_the_currents_that_the_firmware_makes() -> None:
    page = (ROOT / "docs" / "HARDWARE.md").read_text(encoding="utf-8")
    section = "\n".join(currents.table())
    expected = written(page, currents.BEGIN, currents.END, section)
    assert page == expected, "run PYTHONPATH=tools python -m bench.currents --write docs/HARDWARE.md"


def test_a_tile_with_everything_lit_stays_below_the_limits() -> None:
    full = currents.parts(255)
    assert sum(full.values()) <= currents.LIMIT_MA
    assert full["four link LEDs"] <= currents.LED_MA * 1.01, "one at a time"
    assert currents.chip_peak_ma() < currents.CHIP_LIMIT_MA


def test_brightness_0_leaves_no_light() -> None:
    dark = currents.parts(0)
    assert [dark[part] for part in ("seven segments", "RGB LED", "four link LEDs")] == [0, 0, 0]
