"""The code blocks of a document, and how each is to be tested.

A block of `sh` or `python` runs as it is written, in the order of the page, in one folder for each page. An
HTML comment directly above a block says what is different for this block, in clauses with semicolons between:

    <!-- test: with --updates 30 -->            these arguments are added to each command of tilenca
    <!-- test: status 3, no tile on USB here -->  each command ends with this exit status
    <!-- test: parse, needs a tile on USB -->     nothing runs; the parser of each command must accept it

A `toml` block whose first line is `# NAME.toml` or begins with `# NAME.toml:` is that file in the folder.
"""

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

BLOCK = re.compile(
    r"^(?:<!-- test: (?P<mark>[^\n]*?) -->\n)?```(?P<language>[a-z]+)\n(?P<text>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
FILE_NAME = re.compile(r"# ([\w-]+\.toml)(?::|$)", re.MULTILINE)
ANY_MARK = re.compile(r"^<!-- test:.*$", re.MULTILINE)


@dataclass(frozen=True)
class Block:
    """One fenced block of code.

    Attributes:
        place: the document and the line of the fence, for messages.
        language: of the fence.
        text: between the fences.
        more: arguments to add to each command.
        status: with which each command has to end.
        runs: whether it runs; otherwise it is parsed only.
    """

    place: str
    language: str
    text: str
    more: tuple[str, ...] = ()
    status: int = 0
    runs: bool = True

    @property
    def commands(self) -> list[str]:
        """The lines of a `sh` block, without comments."""
        return [line for line in self.text.splitlines() if line and not line.startswith("#")]

    @property
    def file_name(self) -> str | None:
        """The file that a `toml` block is, if it names one."""
        found = FILE_NAME.match(self.text) if self.language == "toml" else None
        return found[1] if found else None


def blocks(document: Path) -> Iterator[Block]:
    """The blocks of a document in their order.

    Raises:
        ValueError: a mark stands above no block, or says something unknown.
    """
    text = document.read_text(encoding="utf-8")
    marks = len(ANY_MARK.findall(text))
    for found in BLOCK.finditer(text):
        line = text.count("\n", 0, found.start("language")) + 1
        mark = found["mark"] or ""
        marks -= bool(mark)
        more, status, runs = _read(mark, f"{document.name}:{line}")
        yield Block(f"{document.name}:{line}", found["language"], found["text"], more, status, runs)
    if marks:
        raise ValueError(f"{document.name}: a mark for tests does not stand directly above a block of code")


def _read(mark: str, place: str) -> tuple[tuple[str, ...], int, bool]:
    more: tuple[str, ...] = ()
    status, runs = 0, True
    for clause in mark.split(";") if mark else ():
        word, _, rest = clause.strip().partition(" ")
        number, _, reason = rest.partition(", ")
        if word == "with":
            more = tuple(shlex.split(rest))
        elif word == "status" and number.isdigit() and reason:
            status = int(number)
        elif word == "parse," and rest:
            runs = False
        else:
            raise ValueError(f"{place}: '{clause.strip()}' is no mark for tests; see test/support/blocks.py")
    return more, status, runs
