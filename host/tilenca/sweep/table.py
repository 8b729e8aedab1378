"""The table of a sweep: its columns, and Parquet and CSV with the same bytes for the same results."""

import csv
import io
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tilenca.base.errors import UsageError
from tilenca.base.project import install_remedy
from tilenca.base.whole_file import write_whole
from tilenca.evaluation.metrics import wilson
from tilenca.sweep.axes import AXES
from tilenca.sweep.counts import Counts
from tilenca.sweep.plan import Plan
from tilenca.sweep.rows import Row

try:
    import pyarrow
    from pyarrow import parquet
except ImportError as error:
    raise UsageError(f"this needs pyarrow, which is not installed; run: {install_remedy('sweep')}") from error

SCHEMA_VERSION = 1
PARQUET, CSV = "table.parquet", "table.csv"
TEXT, WHOLE, REAL = "string", "int64", "float64"
ALL = "all"  # the name of a cell's last row, where it has several drawings
DIGITS = 6

Values = dict[str, Any]


@dataclass(frozen=True)
class Column:
    """A column: its type (`TEXT`, `WHOLE` or `REAL`), and what it says."""

    type: str
    about: str


def _axis_column(name: str) -> Column:
    kind = AXES[name]
    return Column(
        TEXT if kind.most is None else REAL, f"axis {name}: {kind.about}; empty: the engine has none"
    )


COLUMNS: dict[str, Column] = {
    "engine": Column(
        TEXT, "fast: the firmware's core on this machine; emulator: the image on emulated tiles"
    ),
    "model_id": Column(TEXT, "the model's id"),
    **{name.replace("-", "_"): _axis_column(name) for name in AXES},
    "shape": Column(TEXT, f"name of the drawing, or the label of several; {ALL}: all of the cell together"),
    "file": Column(TEXT, "file that the drawing is from; empty for all"),
    "drawings_asked": Column(WHOLE, "different drawings"),
    "tiles": Column(REAL, "tiles of a drawing, on average"),
    "steps": Column(WHOLE, "updates per tile, after which a run is judged"),
    "runs": Column(WHOLE, "runs"),
    "seed": Column(WHOLE, "seed of the sweep"),
    "right": Column(WHOLE, "runs in which every living tile shows the right class at the end"),
    "share": Column(REAL, "right / runs"),
    "low": Column(REAL, "95 % confidence interval of the share (Wilson's), from"),
    "high": Column(REAL, "to"),
    "cells_right": Column(REAL, "share of living tiles that are right at the end, mean over the runs"),
    "median": Column(
        REAL, "steps until all tiles are right and stay so, median; empty: half of the runs never are"
    ),
    "p95": Column(REAL, "the same, 95 % of the runs"),
    "dash": Column(WHOLE, "runs in which all show the dash, and that is not right"),
    "wrong": Column(WHOLE, "runs in which all show the same other class"),
    "split": Column(WHOLE, "runs in which tiles show different classes"),
    "cell_updates": Column(WHOLE, "updates of tiles that were computed"),
    "command": Column(TEXT, "measures just this row again"),
}


def rows_of(plan: Plan, counts: Mapping[str, Counts], command: Callable[[Row, bool], str]) -> list[Values]:
    """The rows of the table: for each cell its drawings, then all of them together.

    Args:
        plan: of the sweep.
        counts: of every block, by its key.
        command: the command of a row, or of the whole cell that it is in.
    """
    found = []
    for cell in plan.cells:
        each = [Counts.total(counts[block.key] for block in row.blocks()) for row in cell]
        for row, mine in zip(cell, each, strict=True):
            about = {"shape": row.subject.name, "file": row.subject.file, "command": command(row, False)}
            found.append(_values(row, [row], mine, plan.luggage.seed) | about)
        if len(cell) > 1:
            about = {"shape": ALL, "command": command(cell[0], True)}
            found.append(_values(cell[0], cell, Counts.total(each), plan.luggage.seed) | about)
    return found


def _values(row: Row, rows: Sequence[Row], counts: Counts, seed: int) -> Values:
    low, high = wilson(counts.right, counts.runs)
    drawings = sum(len(each.subject.shapes) for each in rows)
    tiles = sum(each.subject.tiles * len(each.subject.shapes) for each in rows) / drawings
    values: Values = dict.fromkeys(COLUMNS)
    values |= {name.replace("-", "_"): value for name, value in row.point.items()}
    return values | {
        "engine": row.engine,
        "model_id": row.model_id,
        "drawings_asked": drawings,
        "tiles": round(tiles, DIGITS),
        "steps": row.steps,
        "runs": counts.runs,
        "seed": seed,
        "right": counts.right,
        "share": round(counts.right / counts.runs, DIGITS),
        "low": round(low, DIGITS),
        "high": round(high, DIGITS),
        "cells_right": round(counts.cells / counts.runs, DIGITS),
        **counts.times(),
        "dash": counts.dash,
        "wrong": counts.wrong,
        "split": counts.split,
        "cell_updates": counts.updates,
    }


def write_parquet(folder: Path, rows: Sequence[Values], about: Mapping[str, str]) -> Path:
    """Writes the table as Parquet.

    Args:
        folder: to write into.
        rows: of `rows_of`.
        about: goes into the file's metadata, beside the version of the schema and what each column says.

    Raises:
        TilencaError: it cannot be written.
    """
    types = {TEXT: pyarrow.string(), WHOLE: pyarrow.int64(), REAL: pyarrow.float64()}
    schema = pyarrow.schema(
        [
            pyarrow.field(name, types[column.type], metadata={"about": column.about})
            for name, column in COLUMNS.items()
        ],
        metadata={
            "tilenca.schema_version": str(SCHEMA_VERSION),
            **{f"tilenca.{k}": v for k, v in about.items()},
        },
    )
    table = pyarrow.Table.from_pylist(list(rows), schema=schema)
    buffer = io.BytesIO()
    parquet.write_table(table, buffer)
    return _write(folder / PARQUET, buffer.getvalue())


def write_csv(folder: Path, rows: Sequence[Values]) -> Path:
    """Writes the table as CSV, with a line of names; what is not known is empty.

    Raises:
        TilencaError: it cannot be written.
    """
    text = io.StringIO()
    writer = csv.DictWriter(text, list(COLUMNS), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return _write(folder / CSV, text.getvalue().encode())


def read_parquet(path: Path) -> tuple[list[Values], dict[str, str]]:
    """The rows of a table, and what its metadata say.

    Raises:
        UsageError: it is no table of a sweep, or of another version of the schema.
    """
    try:
        table = parquet.read_table(path)
    except (OSError, pyarrow.ArrowException) as error:
        raise UsageError(f"{path}: not a table of `tilenca sweep` ({error})") from error
    about = {key.decode(): value.decode() for key, value in (table.schema.metadata or {}).items()}
    if about.get("tilenca.schema_version") != str(SCHEMA_VERSION):
        raise UsageError(
            f"{path}: not a table of version {SCHEMA_VERSION}; measure it again with `tilenca sweep`"
        )
    return table.to_pylist(), about


def _write(path: Path, data: bytes) -> Path:
    write_whole(path, data, "make room there, and run the same again")
    return path


def identity_text(identity: Mapping[str, Any]) -> str:
    """What decides the table, as text for its metadata."""
    return json.dumps(identity, sort_keys=True)
