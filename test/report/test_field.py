"""The field's table has an answer for every column, and every number of ours is a row of the full report."""

import json
import re
from importlib import resources

import pytest

from tilenca.base import paths
from tilenca.report.field import LACKING, field_of

TEXT = resources.files("tilenca.report").joinpath("field.toml").read_text(encoding="utf-8")


def test_every_point_has_an_answer_for_each_column() -> None:
    field = field_of({}, quick=True)
    assert field.columns[-1] == "tilenca"
    assert len(field.rows) > 8
    assert all(len(row) == 1 + len(field.columns) and all(row) for row in field.rows)
    assert len(field.sources) == len(field.columns)


def test_numbers_of_ours_are_those_of_the_report_or_said_to_be_lacking() -> None:
    key = re.findall(r"\{([^}]+)\}", TEXT)[0]
    assert any("0.123" in row[-1] for row in field_of({key: "0.123"}, quick=True).rows)
    assert any(LACKING in row[-1] for row in field_of({}, quick=True).rows)
    with pytest.raises(KeyError):
        field_of({}, quick=False)


def test_the_full_report_that_is_committed_lacks_none_of_them() -> None:
    told = (paths.ROOT / "docs" / "RESULTS.md").read_text(encoding="utf-8")
    assert "## The field" in told
    assert LACKING not in told
    page = (paths.ROOT / "docs" / "results.html").read_text(encoding="utf-8")
    for key in re.findall(r"\{([^}]+)\}", TEXT):
        assert f"<tr id={json.dumps(key)}>" in page
