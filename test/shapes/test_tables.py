"""A table of a shape file knows where it stands, whatever it is that is wrong with it."""

from pathlib import Path

import pytest

from tilenca.base.errors import UsageError
from tilenca.base.parsing import read_toml
from tilenca.shapes.tables import Table, tables_of

PATH = Path("mine.toml")


def tables(text: str) -> list[Table]:
    return list(tables_of(PATH, text, read_toml(text)["shape"]))


def test_the_lines_of_a_table_are_those_of_the_file() -> None:
    first, second = tables(
        '\n[[shape]]\nlabel = "1"\ngrid = """\n#\n#\n"""\n[[shape]]\n# a note\nlabel = "7"\ngrid = "#"\n'
    )
    assert (first.lines.header, first.lines.label, first.lines.grid) == (2, 3, 5)
    assert (second.lines.header, second.lines.label, second.lines.grid) == (8, 10, 11)
    assert (first.label(), first.rows()) == ("1", ("#", "#"))


@pytest.mark.parametrize(
    ("label", "remedy"),
    [("4", 'mine.toml:2: label 4; write "4", in quotes'), ('"%"', "mine.toml:2: label '%'; ")],
)
def test_a_label_that_cannot_be_names_its_line(label: str, remedy: str) -> None:
    (table,) = tables(f'[[shape]]\nlabel = {label}\ngrid = "#"\n')
    with pytest.raises(UsageError) as refused:
        table.label()
    assert str(refused.value).startswith(remedy)


def test_a_table_without_lines_of_its_own_is_named_by_its_number() -> None:
    (table,) = tables('shape = [{label = "1", grid = 5}]\n')
    with pytest.raises(UsageError, match=r"^mine\.toml: shape 1: "):
        table.rows()
