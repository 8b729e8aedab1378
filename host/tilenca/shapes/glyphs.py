"""What a tile can show: characters on a 7-segment digit, and the colour of each class.

A glyph is a bit mask of segments, bit 0 = a ... bit 6 = g, bit 7 = dp::

     aaa
    f   b
     ggg
    e   c
     ddd  dp
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

SEGMENT_NAMES = "abcdefg"
DECIMAL_POINT = 1 << 7
BLANK = 0

_LIT: dict[str, str] = {
    "0": "abcdef", "1": "bc", "2": "abdeg", "3": "abcdg", "4": "bcfg",
    "5": "acdfg", "6": "acdefg", "7": "abc", "8": "abcdefg", "9": "abcdfg",
    "A": "abcefg", "b": "cdefg", "C": "adef", "c": "deg", "d": "bcdeg", "E": "adefg",
    "F": "aefg", "G": "acdef", "H": "bcefg", "h": "cefg", "I": "ef", "J": "bcde",
    "K": "acefg", "L": "def", "M": "aceg", "n": "ceg", "o": "cdeg", "P": "abefg",
    "q": "abcfg", "r": "eg", "S": "acdfg", "t": "defg", "U": "bcdef", "u": "cde",
    "V": "bdf", "W": "bdfg", "X": "bceg", "Y": "bcdfg", "Z": "abdeg", "-": "g", "_": "d", "=": "dg",
}  # fmt: skip

GLYPHS: dict[str, int] = {
    label: sum(1 << SEGMENT_NAMES.index(name) for name in lit) for label, lit in _LIT.items()
}

_DIGITS = frozenset("0123456789")

# Duty of 255 per colour, tuned by the paper's authors to the brightness of their LEDs and resistors.
# In order: white, green, blue, orange, aquamarine, purple, yellow, red, pink, pale.
_PAPER_COLOURS: tuple[tuple[int, int, int], ...] = (
    (20, 20, 20), (0, 20, 0), (0, 0, 30), (70, 25, 0), (5, 50, 30),
    (40, 12, 60), (50, 50, 0), (55, 0, 0), (75, 25, 30), (25, 15, 15),
)  # fmt: skip

# A screen shows LEDs as bright as it gets, since they are dim and screens are not, and a little pale.
SCREEN_GAMMA, SCREEN_PALENESS, SCREEN_PEAK, SCREEN_SHADE = 1.6, 0.3, 0.94, 0.68

Duty: TypeAlias = tuple[int, int, int]


@dataclass(frozen=True)
class Look:
    """How a class looks on a tile: twin of `Look` in firmware/include/core/model.h.

    Attributes:
        label: the character that names it.
        segments: the bit mask that shows the label.
        colour: RGB duty, 0..255 each.
    """

    label: str
    segments: int
    colour: Duty


# A tile that shows nothing.
DARK_LOOK = Look("", BLANK, (0, 0, 0))


def look_of(label: str, index: int) -> Look:
    """How the class `index` looks that is called `label`: the one rule for tiles, screens and films.

    A decimal digit has its own colour wherever it stands among the classes; another label has that of its
    index. A label that no 7-segment digit can show, which only a foreign tile may have, lights none.
    """
    return Look(label, GLYPHS.get(label, BLANK), _colour(int(label) if label in _DIGITS else index))


def look_of_class(labels: Sequence[str], index: int) -> Look:
    """How a class of a model with these labels looks."""
    return look_of(labels[index], index)


def looks_of(labels: Sequence[str]) -> list[Look]:
    """How every class looks, in their order."""
    return [look_of_class(labels, index) for index in range(len(labels))]


def _colour(number: int) -> Duty:
    """RGB duty: the paper's ten, then the same ones at a third, then at a ninth."""
    red, green, blue = _PAPER_COLOURS[number % len(_PAPER_COLOURS)]
    dim = 3 ** (number // len(_PAPER_COLOURS))
    return (-(-red // dim), -(-green // dim), -(-blue // dim))


# How often each colour was dimmed; where two are the same in so few steps of duty, the brighter one counts.
_DIMMED = {_colour(number): number // len(_PAPER_COLOURS) for number in reversed(range(30))}


def screen_colour(duty: Duty) -> tuple[float, float, float]:
    """RGB (0..1 each) in which a screen shows an LED of this duty; dimmer repetitions are darker shades."""
    strongest = max(duty)
    if strongest == 0:
        return (0.0, 0.0, 0.0)
    shade = SCREEN_SHADE ** _DIMMED.get(duty, 0)

    def brightness(part: int) -> float:
        lifted: float = (part / strongest) ** (1 / SCREEN_GAMMA)
        return shade * (SCREEN_PALENESS + (SCREEN_PEAK - SCREEN_PALENESS) * lifted)

    return brightness(duty[0]), brightness(duty[1]), brightness(duty[2])


@lru_cache(1024)
def label_of_glyph(segments: int, known: tuple[str, ...] = ()) -> str:
    """The character that lit `segments` show; "" for a dark display, "?" for no known character.

    `known` labels come first: "5" and "S" light the same segments.
    """
    lit = segments & ~DECIMAL_POINT
    if lit == BLANK:
        return ""
    for label in (*known, *GLYPHS):
        if GLYPHS.get(label) == lit:
            return label
    return "?"


def draw(segments: int) -> tuple[str, str, str]:
    """Three text rows of three characters that look like the lit digit."""

    def lit(name: str, mark: str) -> str:
        return mark if segments >> SEGMENT_NAMES.index(name) & 1 else " "

    return (
        f" {lit('a', '_')} ",
        f"{lit('f', '|')}{lit('g', '_')}{lit('b', '|')}",
        f"{lit('e', '|')}{lit('d', '_')}{lit('c', '|')}",
    )
