"""The table: what its columns say, and that the same results are the same bytes."""

import csv
import sys
from pathlib import Path
from typing import Any

import pytest

from support.sweeps import plan
from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.evaluation.metrics import wilson
from tilenca.sweep.counts import Counts
from tilenca.sweep.plan import Plan
from tilenca.sweep.table import ALL, COLUMNS, SCHEMA_VERSION, read_parquet, rows_of, write_csv, write_parquet

PLAN = plan("loss=0,0.5", "size=7x6,drawn", only=("4", "7"), runs=8)


def counts_of(of: Plan) -> dict[str, Counts]:
    """Made up, different for every block."""
    blocks = [block for row in of.rows for block in row.blocks()]
    return {
        block.key: Counts(
            8, number % 9, 0, 0, 8 - number % 9, number % 9 + 0.5, {number + 1: number % 9}, 100
        )
        for number, block in enumerate(blocks)
    }


def table() -> list[dict[str, Any]]:
    return rows_of(PLAN, counts_of(PLAN), lambda row, whole: f"measure {ALL if whole else row.subject.name}")


def test_rows_are_the_drawings_of_a_cell_and_all_of_them() -> None:
    rows = table()
    assert [row["shape"] for row in rows] == ["4", "7", ALL] * 4
    assert [(row["loss"], row["size"]) for row in rows[::3]] == [
        (0.0, "7x6"),
        (0.0, "drawn"),
        (0.5, "7x6"),
        (0.5, "drawn"),
    ]
    assert [row["command"] for row in rows[:3]] == ["measure 4", "measure 7", f"measure {ALL}"]
    assert all(row.keys() == COLUMNS.keys() for row in rows)


def test_all_is_the_sum_and_has_its_own_interval() -> None:
    one, two, both = table()[3:6]
    assert both["runs"] == one["runs"] + two["runs"] == 16
    assert both["right"] == one["right"] + two["right"]
    assert (both["low"], both["high"]) == tuple(round(limit, 6) for limit in wilson(both["right"], 16))
    assert both["share"] == round(both["right"] / 16, 6)
    assert both["drawings_asked"] == 2
    assert both["file"] is None


def test_parquet_gives_back_what_was_written(tmp_path: Path) -> None:
    path = write_parquet(tmp_path, table(), {"command": "tilenca sweep"})
    rows, about = read_parquet(path)
    assert rows == table()
    assert about["tilenca.command"] == "tilenca sweep"
    assert about["tilenca.schema_version"] == str(SCHEMA_VERSION)
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


def test_the_same_rows_are_the_same_bytes(tmp_path: Path) -> None:
    files = []
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        files.append(write_parquet(tmp_path / name, table(), {}).read_bytes())
    assert files[0] == files[1]


def test_csv_has_the_same_columns_and_empty_for_unknown(tmp_path: Path) -> None:
    with write_csv(tmp_path, table()).open(newline="") as file:
        found = list(csv.DictReader(file))
    assert list(found[0]) == list(COLUMNS)
    assert (found[0]["delay"], found[2]["file"], found[0]["median"]) == ("", "", "")
    assert [row["shape"] for row in found] == [row["shape"] for row in table()]


def test_another_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "table.parquet").write_text("no table")
    with pytest.raises(UsageError, match="not a table of `tilenca sweep`"):
        read_parquet(tmp_path / "table.parquet")
    with pytest.raises(UsageError, match="not a table of `tilenca sweep`"):
        read_parquet(tmp_path / "nothing.parquet")


def test_every_column_says_what_it_is_in_the_document() -> None:
    text = (paths.ROOT / "docs" / "SWEEPS.md").read_text(encoding="utf-8")
    for name, column in COLUMNS.items():
        assert f"| `{name}` | {column.type} | {column.about} |" in text


def test_without_pyarrow_the_remedy_is_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    monkeypatch.delitem(sys.modules, "tilenca.sweep.table")
    with pytest.raises(UsageError, match="needs pyarrow, which is not installed; run: make setup-train"):
        __import__("tilenca.sweep.table")
