"""Sentences in words for people. Standard library only: PlatformIO's monitor uses it too."""

import re

from tilenca.base.sides import SIDES
from tilenca.protocol.sentences import (
    AckSentence,
    BoardSentence,
    ChipSentence,
    ErrorSentence,
    HelloSentence,
    LinkSentence,
    NakSentence,
    OtherVersionSentence,
    Sentence,
    TileSentence,
    TimeSentence,
    type_of,
)

SHOWN_BYTES = 60
_WHOLE = re.compile(r"-?[0-9]{1,9}")
# Bits of MCUSR.
RESET_CAUSES = ("power-on", "its reset pin", "brown-out", "watchdog", "JTAG")
NAK_REASONS = {
    "CHECKSUM": "damaged",
    "LONG": "too long",
    "UNKNOWN": "no such command",
    "VALUE": "wrong field",
    "EEPROM": "the EEPROM did not keep it",
    "MARKED": "it has another marking; --replace replaces it",
}


def whole_number(text: str) -> int | None:
    """The number that a person typed, in the digits of this program's own texts; None if it is none."""
    return int(text) if _WHOLE.fullmatch(text) else None


def printable(raw: bytes) -> str:
    """Bytes as text that cannot disturb a terminal, cut to a readable length."""
    text = repr(raw[:SHOWN_BYTES])[2:-1]
    return text if len(raw) <= SHOWN_BYTES else f"{text}... ({len(raw)} bytes)"


def reset_words(cause: int) -> str:
    """The causes of a reset; "unknown" where no bit is set."""
    return " and ".join(name for bit, name in enumerate(RESET_CAUSES) if cause >> bit & 1) or "unknown"


def said(sentence: Sentence) -> str:
    """The tile's id, the sentence's name, and its words."""
    return f"tile {sentence.tile} {type_of(sentence)} {words(sentence)}"


def words(sentence: Sentence) -> str:
    """A sentence in words, without the tile's id and the sentence's name."""
    match sentence:
        case TileSentence(_, uptime_ms, updates, label, _, margin, links, _):
            shown = (label or "nothing") if margin is None else f"{label} margin {margin}"
            return f"shows {shown} update {updates} up {uptime_ms / 1000:.1f} s links {links}"
        case LinkSentence():
            return _link_words(sentence)
        case HelloSentence():
            return _hello_words(sentence)
        case TimeSentence(_, _, compute_us, awake_permille, gap_us, stack_unused, dropped):
            times = f"computes {compute_us} us awake {awake_permille / 10:.1f} % longest turn {gap_us} us"
            return f"{times} stack {stack_unused} bytes unused {dropped} sentences dropped"
        case ChipSentence():
            return _chip_words(sentence)
        case BoardSentence():
            return _board_words(sentence)
        case ErrorSentence(_, _, code, text):
            return f"{code} {text}"
        case AckSentence(_, command, fields):
            return " ".join((command, *fields))
        case NakSentence(_, reason, command):
            return f"{command or 'sentence'}: {NAK_REASONS.get(reason, reason)}"
        case OtherVersionSentence():
            return sentence.remedy


def _hello_words(hello: HelloSentence) -> str:
    model = f"model {hello.model_id:04X} ({hello.channels} channels, {hello.classes} classes)"
    limit = f"{hello.updates} updates" if hello.updates else "for ever"
    pace = f"every {hello.period_ms} ms {limit} brightness {hello.brightness}"
    return (
        f"protocol {hello.version} firmware {hello.firmware_id:08X} {model} {pace} "
        f"reset by {reset_words(hello.reset_cause)}"
    )


def _chip_words(chip: ChipSentence) -> str:
    fuses = f"fuses low {chip.low:02X} high {chip.high:02X} extended {chip.extended:02X} lock {chip.lock:02X}"
    return fuses if chip.revision is None else f"{fuses} board revision {chip.revision} serial {chip.serial}"


def _board_words(board: BoardSentence) -> str:
    supply = "not known" if board.supply_mv is None else f"{board.supply_mv / 1000:.2f} V"
    errors = " ".join(f"{side} {count}" for side, count in zip(SIDES, board.framing_errors, strict=True))
    low = " ".join(f"{side} {ms} ms" for side, ms in zip(SIDES, board.low_ms, strict=True))
    return f"supply {supply} framing errors {errors} low for {low}"


def _link_words(link: LinkSentence) -> str:
    counts = f"sent {link.sent} received {link.received} corrupt {link.corrupt} lost {link.lost}"
    age = "never" if link.age_ms is None else f"{link.age_ms} ms"
    text = f"{link.side} {counts} foreign {link.foreign} overruns {link.overruns} age {age}"
    return text if link.neighbour is None else f"{text} from tile {link.neighbour} {link.neighbour_side}"
