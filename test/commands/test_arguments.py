"""The values that commands take, and how wrong ones are refused."""

import argparse
import re
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, get_args

import pytest

from tilenca import cli
from tilenca.base import paths
from tilenca.base.shipped import model_folder
from tilenca.commands import arguments
from tilenca.commands.arguments import Parser, add_fleet_arguments
from tilenca.simulator.conditions import ScheduleKind


@pytest.mark.parametrize(
    ("parse", "text", "value"),
    [
        (arguments.positive, "0.001", 0.001),
        (arguments.positive, "1e3", 1000.0),
        (arguments.not_negative, "0", 0.0),
        (arguments.share, "1", 1.0),
        (arguments.count, "1000000", 1_000_000),
        (arguments.seed, "0", 0),
        (arguments.seed, str(2**63 - 1), 2**63 - 1),
        (arguments.whole(-3, 3), "-3", -3),
        (arguments.size, "5x4", (5, 4)),
    ],
)
def test_the_limits_themselves_are_taken(parse: Callable[[str], Any], text: str, value: Any) -> None:
    assert parse(text) == value


@pytest.mark.parametrize(
    ("parse", "text", "words"),
    [
        (arguments.positive, "0", "'0' is not a number from 0.001"),
        (arguments.positive, "inf", "is not a number from 0.001"),
        (arguments.not_negative, "nan", "'nan' is not a number from 0"),
        (arguments.not_negative, "", "'' is not a number from 0"),
        (arguments.share, "1.1", "from 0 to 1"),
        (arguments.share, "-0.1", "from 0 to 1"),
        (arguments.count, "0", "'0' is not a whole number from 1 to 1000000"),
        (arguments.count, "1.5", "'1.5' is not a whole number"),
        (arguments.count, "1000001", "from 1 to 1000000"),
        (arguments.seed, str(2**63), "is not a whole number"),
        (arguments.size, "5", "5"),
    ],
)
def test_what_lies_beyond_is_refused_with_the_range(
    parse: Callable[[str], Any], text: str, words: str
) -> None:
    with pytest.raises(argparse.ArgumentTypeError) as caught:
        parse(text)
    assert words in str(caught.value)


def test_a_complaint_is_one_line_with_the_way_to_help(capsys: pytest.CaptureFixture[str]) -> None:
    parser = Parser(prog="tilenca emulate")
    parser.add_argument("--runs", type=arguments.count)
    with pytest.raises(SystemExit, match="2"):
        parser.parse_args(["--runs", "a\nb"])
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("tilenca emulate: argument --runs: 'a b' is not a whole number")
    assert said.err.endswith("; see tilenca emulate --help\n")
    assert said.err.count("\n") == 1


def test_an_unknown_option_is_refused_by_the_subcommand_that_does_not_know_it(
    capsys: pytest.CaptureFixture[str],
) -> None:
    parser = Parser(prog="tilenca")
    parser.add_subparsers().add_parser("emulate")
    with pytest.raises(SystemExit, match="2"):
        parser.parse_args(["emulate", "--fly"])
    assert capsys.readouterr().err.startswith("tilenca emulate: unrecognized arguments: --fly")


def test_ports_add_up_and_none_is_the_default() -> None:
    parser = Parser()
    add_fleet_arguments(parser)
    assert parser.parse_args([]).port == []
    found = parser.parse_args(["--port", "/dev/a", "--port", "/dev/b*", "--tiles", "f.toml"])
    assert (found.port, str(found.tiles)) == (["/dev/a", "/dev/b*"], "f.toml")


@pytest.mark.parametrize(("option", "fits"), [("--shapes", "shapes/hex.toml"), ("--model", "models/hex")])
def test_what_comes_with_tilenca_has_a_short_name_in_every_command_from_any_folder(
    option: str, fits: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    takers = []
    for command in cli.COMMANDS:
        parser = Parser()
        import_module(cli.COMMANDS[command][0]).add_arguments(parser)
        if f"\n  {option} " not in parser.format_help():
            continue
        takers.append(command)
        needed = ["--out", "mine"] if command in ("sweep", "train") else []
        value = getattr(parser.parse_args([*needed, option, "hex"]), option[2:])
        if command == "sweep" and value == "hex":  # its rows have the name, and it finds the model itself
            value = model_folder(value)
        assert value in (paths.ROOT / fits, [paths.ROOT / fits]), command
        assert re.search(
            r"one\s+of:\s+(damage\s+)?digits\s.*\bhex\b.*\bpentominoes\b", parser.format_help(), re.DOTALL
        ), command
    assert {"evaluate", "plot", "simulate"} <= set(takers)


def test_every_schedule_of_the_simulator_can_be_asked_for() -> None:
    assert sorted(arguments.SCHEDULES) == sorted(get_args(ScheduleKind))
