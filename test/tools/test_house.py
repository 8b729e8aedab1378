"""Files are short and functions shallow, so that a reader sees each of them whole."""

import ast
import subprocess
from pathlib import Path

import pytest

from tilenca.base import paths

MOST_LINES = 300
MOST_LEVELS = 5  # of blocks inside a function
# Longer or deeper for a reason; a file that no longer needs its exception must leave this list.
LONG: dict[str, str] = {
    "firmware/src/model/model.cpp": "rendered by `tilenca export`: mostly weights",
}
DEEP: dict[str, str] = {}

BLOCKS = (ast.For, ast.While, ast.If, ast.With, ast.Try, ast.Match, ast.FunctionDef)
SOURCES = {".py", ".cpp", ".c", ".h", ".S", ".inc", ".sh", ".j2"}


def tracked() -> list[Path]:
    """The product's own sources; tests may be as long as their subject."""
    listed = subprocess.run(
        ["git", "ls-files", "host", "tools", "firmware", "monitor"],
        cwd=paths.ROOT, capture_output=True, text=True, check=True,
    )  # fmt: skip
    found = [paths.ROOT / name for name in listed.stdout.splitlines()]
    return [path for path in found if path.suffix in SOURCES and path.is_file()]


def levels(node: ast.AST, level: int = 0) -> int:
    """The deepest nesting of blocks below `node`; an `elif` is as deep as its `if`."""
    deepest = level
    for name, value in ast.iter_fields(node):
        children = value if isinstance(value, list) else [value]
        is_elif = isinstance(node, ast.If) and name == "orelse" and len(children) == 1
        for child in children:
            if isinstance(child, ast.AST):
                same = is_elif and isinstance(child, ast.If)
                deepest = max(deepest, levels(child, level + (isinstance(child, BLOCKS) and not same)))
    return deepest


def name_of(path: Path) -> str:
    return str(path.relative_to(paths.ROOT))


def test_no_file_is_longer_than_a_reader_likes() -> None:
    found = {name_of(path) for path in tracked() if len(path.read_text().splitlines()) > MOST_LINES}
    assert found == set(LONG), "split the file, or write down why it is so long"


def test_no_function_is_deeper_than_a_reader_likes() -> None:
    deep = set()
    for path in tracked():
        if path.suffix == ".py":
            functions = [n for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.FunctionDef)]
            if any(levels(function) > MOST_LEVELS for function in functions):
                deep.add(name_of(path))
    assert deep == set(DEEP), "take blocks out into functions, or write down why it is so deep"


@pytest.mark.parametrize(
    ("text", "deepest"),
    [
        ("pass", 0),
        ("if a:\n  pass\nelif b:\n  pass\nelse:\n  pass", 1),
        ("for a in b:\n  if a:\n    pass\n  else:\n    with c:\n      pass", 3),
    ],
)
def test_levels_are_counted_as_a_reader_counts_them(text: str, deepest: int) -> None:
    assert levels(ast.parse(text)) == deepest
