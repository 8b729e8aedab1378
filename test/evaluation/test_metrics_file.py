"""The measurements beside a model are read as they were written, or refused with the remedy."""

import json
from pathlib import Path

import pytest
from hypothesis import given, settings

from support.refusal import read_or_refused
from support.strategies import damaged
from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.evaluation.metrics_file import METRICS_FILE, read_metrics
from tilenca.views.abilities import abilities, targets_by_kind

ROW = {"key": "drawings", "name": "x", "share": 0.5, "target": 1.0, "holds": False}
METRICS = {
    "rows": [ROW, {**ROW, "target": None}],
    "targets_held": "0 of 1",
    "shortfall": 0.5,
    "iterations": 9,
}


def test_every_model_that_ships_has_its_measurements() -> None:
    for about in sorted(paths.MODELS.glob("*/model.json")):
        metrics = read_metrics(about.parent)
        aimed = [row for row in metrics["rows"] if row["target"] is not None]
        assert metrics["targets_held"] == f"{sum(row['holds'] for row in aimed)} of {len(aimed)}"


def test_a_model_without_them_has_none(tmp_path: Path) -> None:
    assert read_metrics(tmp_path) == {}


@settings(max_examples=300)
@given(damaged(json.dumps(METRICS).encode()))
def test_any_bytes_are_measurements_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    path = tmp_path_factory.mktemp("fuzz") / METRICS_FILE
    metrics = read_or_refused(path, content, lambda path: read_metrics(path.parent))
    if metrics is not None:
        assert all(0 <= targets.held <= targets.given for targets in targets_by_kind(metrics).values())
        assert all(isinstance(line, str) for line in abilities({"rows": [], **metrics}))


@pytest.mark.parametrize(
    "text",
    [
        "{",
        "[]",
        '{"rows": 3}',
        '{"rows": [3]}',
        '{"targets_held": 3}',
        '{"iterations": "many"}',
        '{"iterations": NaN}',
        f'{{"shortfall": {"9" * 400}}}',  # more than a float can hold
        json.dumps({"rows": [{**ROW, "share": None}]}),
        json.dumps({"rows": [{**ROW, "target": "1"}]}),
        json.dumps({"rows": [{**ROW, "holds": 1}]}),
    ],
)
def test_what_is_no_measurement_is_refused_with_the_remedy(text: str, tmp_path: Path) -> None:
    (tmp_path / METRICS_FILE).write_text(text)
    with pytest.raises(UsageError, match=r"metrics\.json: .*; get (it|them) again, or train again"):
        read_metrics(tmp_path)


def test_a_file_that_cannot_be_read_says_so(tmp_path: Path) -> None:
    (tmp_path / METRICS_FILE).mkdir()
    with pytest.raises(UsageError, match=r"metrics\.json: Is a directory; make it a file that can be read"):
        read_metrics(tmp_path)
