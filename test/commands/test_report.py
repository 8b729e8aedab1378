"""`tilenca report`, on a few of its experiments."""

import json
import shlex
from dataclasses import replace
from pathlib import Path

import pytest

from support.schemas import fits
from tilenca import cli
from tilenca.base import paths
from tilenca.report import experiments

SOME = ("paper.digits.listing.10", "paper.curve.7", "gap.fast.60", "gap.tiles.60", "edges.dead")


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Some experiments with few runs."""
    some = [one for one in experiments.EXPERIMENTS if one.key in SOME]
    some = [replace(one, runs=(1, 1)) for one in some]
    monkeypatch.setattr(experiments, "EXPERIMENTS", tuple(some))


@pytest.mark.usefixtures("few", "firmware")
def test_a_report_is_measured_once_and_each_number_repeats(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    out = tmp_path / "report"
    assert cli.main(["report", "--quick", "--out", str(out), "--jobs", "2", "--json"]) == 0
    said = capsys.readouterr()
    result = json.loads(said.out)
    assert fits("report", result)
    assert json.loads((out / "report.json").read_text())["rows"] == result["rows"]
    page = (out / "report.html").read_text()
    assert page.count("<svg") == 3
    assert "The field" in page
    assert {row["key"].split(".")[0] for row in result["rows"]} == {"paper", "edges", "gap"}
    for row in result["rows"]:
        assert row.keys() >= {"key", "value", "low", "high", "runs", "command"}
    # All is there now: nothing runs again.
    assert cli.main(["report", "--quick", "--out", str(out), "--json"]) == 0
    again = capsys.readouterr()
    assert json.loads(again.out) == result
    assert "workers" in said.err
    assert "workers" not in again.err
    for key in ("paper.digits.listing.10.right", "edges.dead.dead-0.03-size-drawn"):
        (row,) = (row for row in result["rows"] if row["key"] == key)
        assert cli.main([*shlex.split(row["command"])[1:], "--json"]) == 0
        repeated = json.loads(capsys.readouterr().out)
        share = repeated["rows"][-1]["share"] if "rows" in repeated else repeated["total_agreement"]
        assert share == row["value"]


@pytest.mark.usefixtures("firmware")
def test_a_folder_that_cannot_be_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    assert cli.main(["report", "--quick", "--out", str(tmp_path / "file")]) in (1, 2)
    said = capsys.readouterr()
    assert said.out == ""
    assert "file" in said.err
    assert "Traceback" not in said.err


@pytest.mark.usefixtures("firmware")
def test_the_firmware_of_another_model_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(paths, "DEFAULT_MODEL", paths.MODELS / "hex")
    assert cli.main(["report", "--quick", "--out", str(tmp_path / "out")]) == 4
    assert "not the firmware of hex; run: tilenca export --model hex && pio run" in capsys.readouterr().err
