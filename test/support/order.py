"""The order of the tests: a long one at the end would keep one processor busy and the others idle."""

from pathlib import Path

# Files with long tests, the longest first.
LONG = (
    "emulator/test_hardship.py",
    "browser/test_tiles_in_the_browser.py",
    "browser/test_for_everybody.py",
    "browser/test_usb.py",
    "fleet/test_fleet.py",
    "docs/test_code_blocks.py",
    "docs/test_fleet_story.py",
    "emulator/test_soak.py",
    "training/test_runner.py",
    "installed/test_wheel.py",
    "emulator/test_kernel.py",
    "commands/test_train.py",
    "commands/test_evaluate.py",
    "evaluation/test_metrics.py",
    "emulator/test_cycles.py",
    "commands/test_emulate.py",
    "emulator/test_hot_plug.py",
)
TESTS = Path(__file__).resolve().parents[1]
_RANK = {TESTS / name: number for number, name in enumerate(LONG)}


def rank(file: Path) -> int:
    """When the tests of a file begin: a lower rank first; files without long tests last, all of one rank."""
    return _RANK.get(file, len(LONG))
