"""What hands do is told as it was given, so that a run can be done again."""

import json

from tilenca.protocol.stream_commands import parse_command, told
from tilenca.protocol.stream_hands import HANDS, Arrange, Blink, Cut, Noise, Pull, Put, Set, Shift, Skew, Turn

SOME = [
    Put(1, -2), Pull("tile-01"), Shift(("tile-01", "tile-02"), 1, -3), Arrange(((0, 0), (4, -4))),
    Cut("a", "E", False), Turn("a", False), Skew("a", -2.5), Noise(0.125), Blink("a", 7),
    Set("period", 30, None), Set("period", 30, "a"),
]  # fmt: skip


def test_a_deed_is_read_back_from_what_is_told() -> None:
    for hand in SOME:
        assert isinstance(hand, HANDS)
        about = told(hand)
        assert about == json.loads(json.dumps(about))
        assert parse_command(json.dumps(about)) == hand
