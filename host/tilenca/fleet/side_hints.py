"""What a side's line points at: a plug, a neighbour's supply, a turned tile. Pure."""

from collections.abc import Collection
from dataclasses import dataclass

from tilenca.base.sides import SIDES
from tilenca.fleet.state import TileView
from tilenca.protocol.sentences import BoardSentence

SUPPLY_REMEDY = (
    "16 MHz need 4.5 V; feed another edge of the array, and look at its plugs (docs/how-to/bring-up.md)"
)
# A plug that is pushed in may make one or two; more in the time between two reports are a fault.
FRAMING_ERRORS = 3


@dataclass(frozen=True)
class SideHint:
    """A fact about one side's line, in a word or two, and a remedy."""

    word: str
    fact: str
    remedy: str

    @property
    def text(self) -> str:
        """The fact and the remedy."""
        return f"{self.fact}: {self.remedy}"


LOW = SideHint(
    "low", "the line stays low", "its neighbour has no power, or pin 3 or 4 of the plug has a short to ground"
)
FRAMING = SideHint(
    "no stop bits", "bytes come without a stop bit", "push the plug in: it may be half in, without ground"
)
ALL_SILENT = SideHint(
    "turned?",
    "its lines are high, and no side hears anybody",
    "the tile is turned by 90 degrees, or not plugged in, or its model is not the others'",
)
ONE_SILENT = SideHint(
    "silent", "the line is high and silent", "the plug is not in, or its pins 3 and 4 are broken"
)


def line_hints(now: BoardSentence, before: BoardSentence | None) -> dict[str, SideHint]:
    """The sides whose line shows something between two reports, or since boot if there was none before."""
    since_ms = now.uptime_ms - (before.uptime_ms if before else 0)
    hints = {}
    for number, side in enumerate(SIDES):
        low_ms = now.low_ms[number] - (before.low_ms[number] if before else 0)
        errors = now.framing_errors[number] - (before.framing_errors[number] if before else 0)
        if 2 * low_ms > since_ms:
            hints[side] = LOW
        elif errors >= FRAMING_ERRORS:
            hints[side] = FRAMING
    return hints


def silence_hints(view: TileView, unheard: Collection[str]) -> dict[str, SideHint]:
    """The sides whose neighbour is there and not heard, although nothing is wrong with the line.

    A tile that is turned by 90 degrees has the right power, but its lines meet those of the same direction:
    all of its sides are silent, and its lines are high. A tile that hears one neighbour is not turned.

    Args:
        view: a tile.
        unheard: the sides at which a tile lies that speaks to the host, and is not heard.
    """
    if view.tile is None or view.board is None:
        return {}
    lines = line_hints(view.board, view.board_before)
    hint = ALL_SILENT if view.tile.links == "----" and not lines else ONE_SILENT
    return {side: hint for side in unheard if side not in lines}
