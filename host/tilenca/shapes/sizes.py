"""The sizes at which a task's drawings keep their class: the table `[sizes]` of a shape file.

[sizes]
from = "5x3"                     # rows x columns; the drawings are stretched to every size from here
to = "12x10"                     # to here, and trained on
more = ["15x13"]                 # and to these
held_out = ["8x5", "20x16"]      # but not to these: they measure a model on new sizes
drawn = ["digits-3x3.toml"]      # files with the same classes, drawn by hand, beside this one
measured = ["other-hands.toml"]  # files that are never trained on: they measure a model on new drawings
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tilenca.base.errors import UsageError
from tilenca.base.suggest import did_you_mean

Size = tuple[int, int]  # rows, columns

LARGEST = 100
KEYS = ("from", "to", "more", "held_out", "drawn", "measured")
_SIZE = re.compile(r"(\d{1,3})x(\d{1,3})")


@dataclass(frozen=True)
class Sizes:
    """Sizes of a task beside those of its own drawings.

    Attributes:
        trained: sizes the drawings are stretched to.
        more: single larger ones, which are not measured.
        held_out: sizes kept for measuring.
        drawn: files of drawings at other sizes.
        measured: files of drawings that are never trained on.
    """

    trained: tuple[Size, ...] = ()
    more: tuple[Size, ...] = ()
    held_out: tuple[Size, ...] = ()
    drawn: tuple[Path, ...] = ()
    measured: tuple[Path, ...] = ()

    def within(self, size: Size, factor: float) -> "Sizes":
        """Those of at most `factor` times as many rows and columns as `size`; none for a factor of 1."""

        def fits(other: Size) -> bool:
            return factor > 1 and other[0] <= factor * size[0] and other[1] <= factor * size[1]

        trained, more, held_out = (
            tuple(filter(fits, part)) for part in (self.trained, self.more, self.held_out)
        )
        return Sizes(trained, more, held_out, self.drawn, self.measured)


def size_name(size: Size) -> str:
    """A size as text, rows x columns."""
    return f"{size[0]}x{size[1]}"


def parse_size(text: str) -> Size:
    """Rows and columns of `5x4`.

    Raises:
        ValueError: it is not a size from 1x1 to 100x100.
    """
    match = _SIZE.fullmatch(text)
    size = (int(match[1]), int(match[2])) if match else (0, 0)
    if not all(1 <= side <= LARGEST for side in size):
        raise ValueError(f"{text!r} is not a size of 1x1 to {LARGEST}x{LARGEST}, like 5x4 (rows x columns)")
    return size


def read_sizes(path: Path, table: object) -> Sizes:
    """Checks the table of a shape file.

    Raises:
        UsageError: an unknown key or not a size; the message names the file, the key and the remedy.
    """
    if not isinstance(table, dict):
        raise UsageError(f"{path}: sizes must be a table; write [sizes] on a line of its own")
    unknown = [key for key in table if key not in KEYS]
    if unknown:
        meant = did_you_mean(unknown[0], KEYS)
        raise UsageError(f"{path}: [sizes] has no '{unknown[0]}'{meant}; it has {', '.join(KEYS)}")
    if ("from" in table) != ("to" in table):
        raise UsageError(f"{path}: [sizes] has one of from and to; give both or neither")
    held_out = tuple(read_size(path, "sizes", "held_out", text) for text in _texts(path, table, "held_out"))
    trained: list[Size] = []
    if "from" in table:
        least, most = (read_size(path, "sizes", key, table[key]) for key in ("from", "to"))
        if not (least[0] <= most[0] and least[1] <= most[1]):
            raise UsageError(f"{path}: [sizes] from {size_name(least)} is larger than to {size_name(most)}")
        trained = [
            (rows, columns)
            for rows in range(least[0], most[0] + 1)
            for columns in range(least[1], most[1] + 1)
            if (rows, columns) not in held_out
        ]
    drawn, measured = (
        tuple(path.parent / name for name in _texts(path, table, key)) for key in ("drawn", "measured")
    )
    more = tuple(read_size(path, "sizes", "more", text) for text in _texts(path, table, "more"))
    for size in more:
        if size in held_out:
            raise UsageError(
                f"{path}: [sizes] {size_name(size)} is in more and in held_out; take it out of one"
            )
    return Sizes(tuple(trained), more, held_out, drawn, measured)


def _texts(path: Path, table: dict[str, object], key: str) -> Sequence[str]:
    texts = table.get(key, [])
    if not isinstance(texts, list) or not all(isinstance(text, str) for text in texts):
        raise UsageError(f'{path}: [sizes] {key} must be a list of texts, like ["..."]')
    return texts


def read_size(path: Path, table: str, key: str, text: object) -> Size:
    """The size that a key of a shape file's table gives.

    Raises:
        UsageError: it is not a size; the message names the file, the table and the key.
    """
    try:
        return parse_size(text if isinstance(text, str) else str(text))
    except ValueError as error:
        raise UsageError(f"{path}: [{table}] {key}: {error}") from error
