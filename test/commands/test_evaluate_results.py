"""What `tilenca evaluate` says of its runs."""

import argparse
from dataclasses import replace

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.commands.evaluate_results import RunResults, print_report, report_of
from tilenca.model.file import load_model
from tilenca.shapes.batch import load_drawings

MODEL = load_model(paths.DEFAULT_MODEL)
DRAWINGS = load_drawings([paths.DEFAULT_SHAPES], labels=MODEL.labels)
ARGS = argparse.Namespace(engine="emulator", schedule="clock", steps=4)
OUTCOME = RunResults(
    np.array([0, 0, 0, 0]),
    np.array([1.0, 1.0, 1.0, 0.5], np.float32),
    np.array([2.0, 1.0, 4.0, np.inf]),
    np.zeros(4, np.bool_),
    agreed_s=np.array([0.2, 0.1, 0.31234567, np.inf]),
)
ONE = replace(DRAWINGS, shapes=DRAWINGS.shapes[:1], groups=DRAWINGS.groups[:1])


def test_agreement_is_told_step_by_step_and_times_with_their_interval() -> None:
    report = report_of(ARGS, MODEL, ONE, 4, OUTCOME)
    assert report["agreed_by_step"] == [0.25, 0.5, 0.5, 0.75]
    assert report["total_agreement"] == 0.75
    assert report["steps_to_agreement"] == {"median": 2.0, "p95": None}
    assert report["seconds_to_agreement"] == {"median": 0.2, "p95": None, "low": 0.1, "high": None}


def test_an_engine_that_knows_steps_only_tells_no_seconds(capsys: pytest.CaptureFixture[str]) -> None:
    report = report_of(ARGS, MODEL, ONE, 4, replace(OUTCOME, agreed_s=None))
    assert report["seconds_to_agreement"] is None
    print_report(report)
    assert "power" not in capsys.readouterr().out


def test_the_table_has_the_times_in_words(capsys: pytest.CaptureFixture[str]) -> None:
    print_report(report_of(ARGS, MODEL, ONE, 4, OUTCOME))
    out = capsys.readouterr().out
    assert "to agreement: median 0.200 s (0.100 s to never), 95 % never" in out
