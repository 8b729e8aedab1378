"""The field's table: what others published, beside the rows of this report.

Numbers of others cannot be measured again here; `field.toml` has them, with their sources.
"""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources

LACKING = "(not in the quick report)"


@dataclass(frozen=True)
class Field:
    """The table.

    Attributes:
        columns: whose answers they are, this project's last.
        rows: what is compared, then an answer for each column.
        sources: of the columns.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    sources: tuple[str, ...]


def field_of(values: Mapping[str, str], quick: bool) -> Field:
    """The table, with this report's numbers.

    Args:
        values: the rows of the report as text, by their keys.
        quick: whether it is the quick one, which may lack some: the table says so.

    Raises:
        KeyError: a full report lacks one.
    """
    text = resources.files("tilenca.report").joinpath("field.toml").read_text(encoding="utf-8")
    told = tomllib.loads(text)

    def value(key: re.Match[str]) -> str:
        return values.get(key[1], LACKING) if quick else values[key[1]]

    def filled(answer: str) -> str:
        return re.sub(r"\{([^}]+)\}", value, answer)

    rows = ((point["what"], *map(filled, point["answers"])) for point in told["points"])
    return Field(tuple(told["columns"]), tuple(rows), tuple(told["sources"]))
