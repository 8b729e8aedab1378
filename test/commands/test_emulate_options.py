"""The options of `tilenca emulate` that exclude each other."""

import argparse

import pytest

from tilenca.base.errors import UsageError
from tilenca.commands.emulate_options import add_emulate_arguments, check_combinations


def parsed(*words: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    add_emulate_arguments(parser)
    return parser.parse_args(words)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--serve", "tiles", "--record", "f"], "--record does nothing with --serve"),
        (["--serve", "tiles", "--updates", "4"], "--updates does nothing with --serve"),
        (["--serve", "."], "--serve needs a directory of its own"),
        (["--pin", "3:H1"], "--pin does nothing without --vcd"),
        (["--keep-running"], "--keep-running does nothing without --serve"),
    ],
)
def test_what_would_be_ignored_is_refused(words: list[str], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        check_combinations(parsed(*words))


def test_what_goes_together_is_not() -> None:
    check_combinations(parsed())
    check_combinations(parsed("--serve", "tiles", "--keep-running", "--seconds", "3"))
    check_combinations(parsed("--vcd", "f", "--pin", "3:H1"))
