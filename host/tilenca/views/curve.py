"""A curve of shares in a few lines of text, for a terminal: what training has reached so far."""

from collections.abc import Sequence

from rich.text import Text

EIGHTHS = " ▁▂▃▄▅▆▇█"
ASCII = " ...:::##"
STYLE = "green"


class Curve:
    """The means of shares over a course of known length; takes new values at any time.

    Args:
        end: of the course; its beginning is 0.
        caption: what the shares are of.
        width: columns of the curve.
        height: lines of it.
    """

    def __init__(self, end: float, caption: str, width: int = 50, height: int = 4) -> None:
        self._end, self._caption, self._height = max(end, 1.0), caption, height
        self._sums = [0.0] * width
        self._counts = [0] * width

    def add(self, at: float, share: float) -> None:
        """A share (0..1) at a place of the course."""
        column = min(int(at / self._end * len(self._sums)), len(self._sums) - 1)
        self._sums[column] += share
        self._counts[column] += 1

    def lines(self, ascii_only: bool = False) -> list[Text]:
        """The curve with its axis; nothing before there is a value."""
        means = self._means()
        if not means:
            return []
        marks = ASCII if ascii_only else EIGHTHS
        corner, side, floor = ("+", "|", "-") if ascii_only else ("└", "│", "─")
        lines = []
        for row in range(self._height):
            above = self._height - 1 - row
            filled = [min(max(round(mean * self._height * 8) - above * 8, 0), 8) for mean in means]
            label = "100 %" if row == 0 else "  0 %" if above == 0 else "     "
            lines.append(Text.assemble(f"{label}{side}", ("".join(marks[n] for n in filled), STYLE)))
        lines.append(Text(f"     {corner}{floor * len(self._sums)}"))
        lines.append(Text(f"      {self._caption}"))
        return lines

    def _means(self) -> list[float]:
        """One for each column up to the last with a value; a column without has that of the one before."""
        known = [column for column, count in enumerate(self._counts) if count]
        means: list[float] = []
        for column in range(known[-1] + 1 if known else 0):
            count = self._counts[column]
            before = means[-1] if means else self._first(known)
            means.append(self._sums[column] / count if count else before)
        return means

    def _first(self, known: Sequence[int]) -> float:
        return self._sums[known[0]] / self._counts[known[0]]
