"""Every experiment is a command that exists, and no two have one name."""

from pathlib import Path

import pytest

from tilenca import cli
from tilenca.report.experiment import Experiment
from tilenca.report.experiments import EXPERIMENTS, TITLES, chosen
from tilenca.report.measure import Call, command_of
from tilenca.report.rows import READERS


@pytest.mark.parametrize(
    ("experiment", "quick"), [(one, quick) for quick in (False, True) for one in chosen(quick)]
)
def test_its_command_exists(experiment: Experiment, quick: bool) -> None:
    call = Call(experiment.key, experiment.arguments(quick))
    words = [*command_of(call, Path("x"))]
    assert not [word for word in words if "{" in word]
    assert "--json" in words
    parsed = cli.build_parser(words[0]).parse_args(words)
    assert parsed.seed > 0
    assert experiment.section in TITLES
    assert experiment.reader in READERS


def test_keys_are_unique_and_the_quick_report_has_every_section() -> None:
    keys = [experiment.key for experiment in EXPERIMENTS]
    assert len(keys) == len(set(keys))
    assert {experiment.section for experiment in chosen(quick=True)} == set(TITLES)
    assert len(chosen(quick=True)) < len(chosen(quick=False)) == len(EXPERIMENTS)
