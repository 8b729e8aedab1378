"""`tilenca emulate --fault SPEC`: faults of tiles and cables, and their times.

KIND[=VALUE][@WHERE][:FROM[-TO]], times in seconds:

    loss=0.1            a tenth of the bytes on all cables is lost
    flip=0.001@3E       of the bits that leave tile 3 to the east, one in a thousand is inverted
    delay=5@3-4:2-3     the cable between tiles 3 and 4 takes 5 ms more, from 2 s to 3 s
    cut@3-4:2-3         that cable is cut at 2 s and mended at 3 s
    off@7:2-3           tile 7 has no power from 2 s to 3 s; without the end, it stays off
    remove@7:2          tile 7 is taken away at 2 s
    reset@7:2           tile 7 is reset at 2 s
    skew=20000@7:2-3    tile 7's clock is 2 % faster from 2 s to 3 s; without a tile, each by up to so much
    turn@7:2-3          tile 7 lies turned by 90 degrees from 2 s to 3 s: its TX meets a TX, no link works
    drift=20@7          tile 7's clock error grows by 20 ppm a second; without a tile, each by up to so much
    adc=2               conversions are off by 2, root mean square
    supply=4.3@7:2-3    tile 7 has 4.3 V from 2 s to 3 s, and 5 V otherwise
"""

import re
from dataclasses import dataclass

from tilenca.base.errors import UsageError
from tilenca.protocol.stream_hands import MAX_SKEW_PPM


class FaultError(UsageError):
    """A fault that cannot be."""


EXAMPLE = "loss=0.1@3E:2-5 or cut@3-4:2"
LINK_KINDS = {"loss": 1.0, "flip": 1.0, "delay": 1000.0}  # with the most each can be
TILE_KINDS = {"drift": 10_000.0, "adc": 100.0, "supply": 5.5, "skew": MAX_SKEW_PPM}
SIGNED_KINDS = ("skew",)
LEAST_V, USUAL_V = 1.8, 5.0
MOMENT_KINDS = ("cut", "off", "remove", "reset", "turn")
KINDS = (*LINK_KINDS, *MOMENT_KINDS, *TILE_KINDS)
SHAPE = re.compile(r"([a-z]+)(?:=([^@:]+))?(?:@([^:]+))?(?::([^-]+)(?:-(.+))?)?")


@dataclass(frozen=True)
class FaultSpec:
    """One parsed `--fault`; see the module.

    Attributes:
        text: as it was given.
        kind: one of the words above.
        value: its number; 0 where it takes none.
        where: as given; "" for everywhere.
        from_s: when it begins.
        to_s: when it ends; None: never.
    """

    text: str
    kind: str
    value: float
    where: str
    from_s: float
    to_s: float | None

    def refuse(self, fact: str) -> "FaultError":
        """The error for this one."""
        return _complaint(self.text, fact)


def _complaint(text: str, fact: str) -> "FaultError":
    return FaultError(f"--fault '{text}': {fact}; for example {EXAMPLE}")


def _number(text: str, part: str, fact: str, signed: bool = False) -> float:
    try:
        value = float(part)
    except ValueError:
        value = float("nan")
    if not 0 <= (abs(value) if signed else value) < float("inf"):
        raise _complaint(text, f"'{part}' is no {fact}")
    return value


def parse(text: str) -> FaultSpec:
    """Parses a `--fault`.

    Raises:
        UsageError: it is not valid; the message says why.
    """
    match = SHAPE.fullmatch(text)
    word = re.match("[a-z]*", text)
    if word is None or word[0] not in KINDS:
        raise _complaint(text, f"it begins with none of {', '.join(KINDS)}")
    if match is None:
        raise _complaint(text, f"after {word[0]} comes [=VALUE][@WHERE][:FROM[-TO]], times in seconds from 0")
    kind, value_text, where, from_text, to_text = match.groups()
    most = (LINK_KINDS | TILE_KINDS).get(kind)
    if (most is None) != (value_text is None):
        raise _complaint(text, f"{kind} takes {'no' if most is None else 'a'} number")
    signed = kind in SIGNED_KINDS
    value = 0.0 if value_text is None else _number(text, value_text, "number", signed)
    if most is not None and abs(value) > most:
        raise _complaint(text, f"{kind} is {-most if signed else 0:g} to {most:g}")
    if kind == "supply" and value < LEAST_V:
        raise _complaint(text, f"supply is {LEAST_V:g} to {most:g} V")
    from_s = 0.0 if from_text is None else _number(text, from_text, "time in seconds")
    to_s = None if to_text is None else _number(text, to_text, "time in seconds")
    if to_s is not None and (to_s <= from_s or kind in ("remove", "reset", "adc", "drift")):
        raise _complaint(text, "it ends before it begins" if to_s <= from_s else f"{kind} has no end")
    if kind in MOMENT_KINDS and where is None:
        raise _complaint(text, f"{kind} needs a place")
    return FaultSpec(text, kind, value, where or "", from_s, to_s)
