"""How far the drawings of a class may differ: the tables `[vary]` and `[forms]` of a shape file.

[vary]
from = "5x3"          # the smallest drawing, rows x columns
to = "14x12"          # and the largest
thickness = [1, 2]    # of the strokes, in tiles
slant = 0.3           # how far the top may lean to a side, as a share of the height
turn = 10             # degrees by which a drawing may be turned
bars = 0.3            # how much the distances between strokes differ: standard deviation of their logarithm
jitter = 0.05         # how far corners and ends move: standard deviation, as a share of the size
corners = 0.5         # the share of drawings with cut or rounded corners
ends = 0.3            # how much longer or shorter free ends become, as a share of the size
hooks = 0.2           # the share of free ends that bend
feet = 0.15           # the share of free ends at the top or bottom with a crossbar

`vary = false` instead of the table keeps a class to its drawings.

[forms]               # other forms of classes: strokes in a unit square, x to the right and y down
"4" = ["0,0 0,.6 1,.6 | .75,.3 .75,1", "1,0 0,.6 1,.6 | 1,0 1,1"]
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from tilenca.base.errors import UsageError
from tilenca.base.suggest import did_you_mean
from tilenca.shapes.sizes import Size, Sizes, read_size, size_name
from tilenca.shapes.skeleton import Skeleton, of_strokes

THICKEST = 9
LEAST_STROKES = 2  # beside each other, for which the largest drawing has room
SMALLER, LARGER = 0.8, 1.8  # times the drawn size


@dataclass(frozen=True)
class Vary:
    """How far drawings of a class may differ; each number is explained above.

    Attributes:
        least: the smallest drawing, rows and columns; None: as `sized` decides.
        most: the largest; likewise.
        thickness: least and most thickness of the strokes, in tiles.
        slant: shift of the top, as a share of the height.
        turn: degrees.
        bars: standard deviation of the logarithm of distances between strokes.
        jitter: standard deviation of the places of corners and ends.
        corners: share of drawings with cut or rounded corners.
        ends: largest change of a free end's length.
        hooks: share of free ends that bend.
        feet: share of free ends at the top or bottom with a crossbar.
    """

    least: Size | None = None
    most: Size | None = None
    thickness: tuple[int, int] = (1, 2)
    slant: float = 0.15
    turn: float = 5.0
    bars: float = 0.2
    jitter: float = 0.04
    corners: float = 0.3
    ends: float = 0.15
    hooks: float = 0.0
    feet: float = 0.0

    def sized(self, drawn: Size, sizes: Sizes) -> "Vary":
        """The same with a smallest and a largest size.

        Args:
            drawn: most rows and columns of the file's drawings.
            sizes: of the file; its trained sizes are the limits, or else the drawn size times `SMALLER` and
                `LARGER`.
        """
        trained = (
            (*sizes.trained, drawn)
            if sizes.trained
            else tuple((round(factor * drawn[0]), round(factor * drawn[1])) for factor in (SMALLER, LARGER))
        )
        least, most = (
            (pick(rows for rows, _ in trained), pick(cols for _, cols in trained)) for pick in (min, max)
        )
        least, most = self.least or least, self.most or most
        return replace(self, least=least, most=(max(least[0], most[0]), max(least[1], most[1])))


# The largest value of every number; all begin at 0.
LIMITS = {
    "slant": 1.0, "turn": 45.0, "bars": 1.0, "jitter": 0.5,
    "corners": 1.0, "ends": 0.5, "hooks": 1.0, "feet": 1.0,
}  # fmt: skip
KEYS = ("from", "to", *(field.name for field in fields(Vary) if field.name not in ("least", "most")))


def read_vary(path: Path, table: object) -> Vary | None:
    """Checks the table `[vary]` of a shape file; what it leaves out has a default.

    Returns:
        None for `vary = false`: the drawings are all there is.

    Raises:
        UsageError: an unknown key, or a value out of range; the message names file, key and remedy.
    """
    if table is False:
        return None
    if not isinstance(table, dict):
        raise UsageError(f"{path}: vary must be a table or false; write [vary] on a line of its own")
    changes: dict[str, Any] = {}
    for key, value in table.items():
        if key not in KEYS:
            meant = did_you_mean(key, KEYS)
            raise UsageError(f"{path}: [vary] has no '{key}'{meant}; it has {', '.join(KEYS)}")
        if key in ("from", "to"):
            changes["least" if key == "from" else "most"] = read_size(path, "vary", key, value)
        else:
            changes[key] = (_thickness if key == "thickness" else _number)(path, key, value)
    vary = replace(Vary(), **changes)
    if vary.most and min(vary.most) < LEAST_STROKES * vary.thickness[0]:
        raise UsageError(
            f"{path}: [vary] thickness {vary.thickness[0]} leaves no room in {size_name(vary.most)}; "
            "give thinner strokes, or a larger to"
        )
    if vary.least and vary.most and not (vary.least[0] <= vary.most[0] and vary.least[1] <= vary.most[1]):
        raise UsageError(
            f"{path}: [vary] from {size_name(vary.least)} is larger than to {size_name(vary.most)}"
        )
    return vary


def _thickness(path: Path, key: str, value: object) -> tuple[int, int]:
    ends = value if isinstance(value, list) else [value, value]
    numbers = [end for end in ends if isinstance(end, int) and not isinstance(end, bool)]
    if len(ends) != 2 or len(numbers) != 2 or not 1 <= numbers[0] <= numbers[1] <= THICKEST:
        raise UsageError(
            f"{path}: [vary] {key} {value!r}; write the least and the most, like [1, 2], up to {THICKEST}"
        )
    return numbers[0], numbers[1]


def _number(path: Path, key: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= LIMITS[key]:
        raise UsageError(f"{path}: [vary] {key} {value!r}; give a number from 0 to {LIMITS[key]:g}")
    return float(value)


def read_forms(path: Path, table: object, labels: Sequence[str]) -> tuple[tuple[str, Skeleton], ...]:
    """The labels and skeletons of a table `[forms]`.

    Args:
        path: the shape file.
        table: as TOML gives it.
        labels: the classes of the file.

    Raises:
        UsageError: an unknown label, or strokes that are not valid; the message says what to write.
    """
    if not isinstance(table, dict):
        raise UsageError(f"{path}: forms must be a table; write [forms] on a line of its own")
    found = []
    for label, texts in table.items():
        if label not in labels:
            raise UsageError(f"{path}: [forms] '{label}' has no [[shape]]; the file has: {' '.join(labels)}")
        if not isinstance(texts, list) or not all(isinstance(text, str) for text in texts):
            raise UsageError(f'{path}: [forms] "{label}" must be a list of texts, like ["0,0 1,0 | 1,0 1,1"]')
        for text in texts:
            try:
                strokes = [[_point(point) for point in stroke.split()] for stroke in text.split("|")]
                found.append((label, of_strokes(strokes)))
            except ValueError as error:
                raise UsageError(f'{path}: [forms] "{label}", {text!r}: {error}') from error
    return tuple(found)


def _point(text: str) -> tuple[float, float]:
    try:
        x, y = map(float, text.split(","))
    except ValueError:
        raise ValueError(f"{text!r} is not a point like 0,.5") from None
    if not (0 <= x <= 1 and 0 <= y <= 1):
        raise ValueError(f"{text!r} lies outside of the unit square")
    return x, y
