"""The examples of the help texts are commands as they can be typed."""

import shlex

import pytest

from tilenca.cli import COMMANDS, build_parser
from tilenca.commands.examples import EXAMPLES, epilog


@pytest.mark.parametrize("command", sorted(COMMANDS))
def test_every_command_has_two_examples_that_parse(command: str) -> None:
    for example in EXAMPLES[command]:
        program, *words = shlex.split(example)
        assert (program, words[0]) == ("tilenca", command)
        assert build_parser(command).parse_args(words).command == command
    assert epilog(command) == f"examples:\n  {EXAMPLES[command][0]}\n  {EXAMPLES[command][1]}"


def test_no_other_command_has_examples() -> None:
    assert EXAMPLES.keys() == COMMANDS.keys()
