"""The patterns of the sentences on USB (docs/PROTOCOL.md section 3).

`SENTENCE` is the frame around all of them; the others match the text between `$` and `*`.
"""

import re

from tilenca.base.sides import SIDES
from tilenca.protocol.constants import MAX_CHANNELS


def _fields(*parts: str) -> re.Pattern[str]:
    return re.compile(",".join(parts))


SENTENCE = re.compile(rb"\$([ -#%-)+-~]*)\*([0-9A-F]{2})")
_NUMBER, _OPTIONAL, _SIDE = r"(\d{1,10})", r"(\d{0,10})", rf"([{SIDES}])"
_WORD, _TEXT = r"([A-Z]{1,16})", r"([ -+\--~]*)"
_HEX2, _HEX4, _HEX8 = (rf"([0-9A-F]{{{digits}}})" for digits in (2, 4, 8))
HELLO = _fields(
    "HELLO", *[_NUMBER] * 2, _HEX4, *[_NUMBER] * 4, _HEX2, _HEX8, _NUMBER + rf"(?:,({len(SIDES)}))?"
)
_STATE = rf"((?:[0-9A-F]{{2}}){{1,{MAX_CHANNELS}}})"
_LABEL, _LINKS, _OPTIONAL_BYTE = r"([!-+\--~]?)", r"([N-][E-][S-][W-])", r"(\d{0,3})"
TILE = _fields("TILE", *[_NUMBER] * 3, _LABEL, *[_OPTIONAL_BYTE] * 2, _LINKS, _STATE)
LINK = _fields("LINK", *[_NUMBER] * 2, _SIDE, *[_NUMBER] * 5, _OPTIONAL, _NUMBER, _OPTIONAL, _SIDE + "?")
TIME = _fields("TIME", *[_NUMBER] * 7)
CHIP = _fields("CHIP", _NUMBER, *[_HEX2] * 4, *[_OPTIONAL] * 2)
BOARD = _fields("BOARD", *[_NUMBER] * 2, _OPTIONAL, *[_NUMBER] * 8)
ERROR = _fields("ERROR", *[_NUMBER] * 2, _WORD, _TEXT)
ACK = re.compile(rf"ACK,{_NUMBER},{_WORD}((?:,[ -+\--~]*)*)")
NAK = _fields("NAK", _NUMBER, _WORD, _TEXT)
# Sentences of other versions, in case the greeting was missed: TILE of versions 1 and 2, LINK of version 1.
OTHER_HELLO = re.compile(rf"HELLO,{_NUMBER},{_NUMBER}(?:,.*)?")
TILE_2 = _fields("TILE", *[_NUMBER] * 3, _LABEL, _LINKS, _STATE)
LINK_1 = _fields("LINK", *[_NUMBER] * 2, _SIDE, *[_NUMBER] * 5, _OPTIONAL)
