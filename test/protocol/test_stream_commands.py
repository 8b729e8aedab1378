"""The page's commands: every good one is understood, and nothing else gets through."""

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tilenca.protocol import stream_commands as commands
from tilenca.protocol import stream_hands as hands
from tilenca.protocol.stream_commands import KINDS, MAX_TEXT, parse_command
from tilenca.protocol.stream_fields import MOST_TILES

GOOD: list[tuple[dict[str, Any], object]] = [
    ({"do": "open", "cells": [[0, 0], [0, 1]]}, commands.Open(((0, 0), (0, 1)))),
    ({"do": "open", "cells": [[1, 2]], "until_s": 3, "seed": 7, "faults": ["loss=0.1"], "paused": True},
     commands.Open(((1, 2),), seed=7, faults=("loss=0.1",), paused=True, until_s=3.0)),
    ({"do": "pace", "speed": 0.1}, commands.Pace(0.1)),
    ({"do": "pace", "speed": 0, "paused": True}, commands.Pace(0.0, True)),
    ({"do": "rest", "on": True}, commands.Rest(True)),
    ({"do": "step", "seconds": 0.02}, commands.Step(0.02)),
    ({"do": "seek", "seconds": 0}, commands.Seek(0.0)),
    ({"do": "seek", "seconds": 1, "forget": True}, commands.Seek(1.0, forget=True)),
    ({"do": "instruct", "port": "tile-03"}, commands.Instruct("tile-03", 1)),
    (
        {
            "do": "open",
            "cells": [[0, 0]],
            "deeds": [[2, {"do": "pull", "port": "a"}], [1, {"do": "reset", "port": "b"}]],
        },
        commands.Open(((0, 0),), deeds=((1.0, hands.Reset("b")), (2.0, hands.Pull("a")))),
    ),
    ({"do": "put", "row": -3, "col": 64}, hands.Put(-3, 64)),
    ({"do": "pull", "port": "tile-03"}, hands.Pull("tile-03")),
    ({"do": "move", "port": "tile-03", "row": 1, "col": 1}, hands.Move("tile-03", 1, 1)),
    ({"do": "shift", "ports": ["a", "b"], "rows": -1, "cols": 128}, hands.Shift(("a", "b"), -1, 128)),
    ({"do": "arrange", "cells": [[0, 0]]}, hands.Arrange(((0, 0),))),
    ({"do": "cut", "port": "tile-03", "side": "E"}, hands.Cut("tile-03", "E", True)),
    ({"do": "power", "port": "tile-03", "on": False}, hands.Power("tile-03", False)),
    ({"do": "freeze", "port": "tile-03", "on": False}, hands.Freeze("tile-03", False)),
    ({"do": "turn", "port": "tile-03"}, hands.Turn("tile-03", True)),
    ({"do": "skew", "port": "tile-03", "ppm": -2e4}, hands.Skew("tile-03", -20_000.0)),
    ({"do": "reset", "port": "tile-03"}, hands.Reset("tile-03")),
    ({"do": "noise", "loss": 0.25}, hands.Noise(0.25)),
    ({"do": "blink", "port": "/dev/ttyACM0"}, hands.Blink("/dev/ttyACM0", 5)),
    ({"do": "restart", "port": "tile-03"}, hands.Restart("tile-03")),
    ({"do": "set", "name": "period", "value": 50}, hands.Set("period", 50, None)),
    ({"do": "set", "name": "brightness", "value": 9, "port": "a"}, hands.Set("brightness", 9, "a")),
    ({"do": "seen", "batch": 12}, commands.Seen(12)),
]  # fmt: skip


@pytest.mark.parametrize(("about", "command"), GOOD)
def test_a_command_is_understood(about: dict[str, Any], command: object) -> None:
    assert parse_command(json.dumps(about)) == command


def test_each_kind_is_among_them() -> None:
    assert {type(command) for _, command in GOOD} == set(KINDS.values())


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "not JSON"),
        ("[]", "a command is an object"),
        ("{}", 'a command has "do"'),
        ('{"do": "explode"}', "one of: open, pace"),
        ('{"do": ["open"]}', 'a command has "do"'),
        ('{"do": "pull"}', "pull: port is missing"),
        ('{"do": "pull", "port": 3}', "pull: port must be a text"),
        ('{"do": "pull", "port": "a\\u0000"}', "pull: port must be a text"),
        ('{"do": "pull", "port": "tile-01", "now": 1}', "pull: it has no 'now'"),
        ('{"do": "put", "row": 1.5, "col": 0}', "put: row must be a whole number"),
        ('{"do": "put", "row": true, "col": 0}', "put: row must be a whole number"),
        ('{"do": "put", "row": 65, "col": 0}', "in -64..64"),
        ('{"do": "pace", "speed": NaN}', "NaN is no number"),
        ('{"do": "pace", "speed": Infinity}', "Infinity is no number"),
        ('{"do": "pace", "speed": 1e999}', "pace: speed must be a number"),
        ('{"do": "pace", "speed": -1}', "or 0"),
        ('{"do": "noise", "loss": 1.1}', "noise: loss must be a number in 0..1"),
        ('{"do": "cut", "port": "tile-01", "side": "NE"}', "must be one of N, E, S, W"),
        ('{"do": "rest", "on": 1}', "must be true or false"),
        ('{"do": "set", "name": "id", "value": 1}', "name must be one of period, updates, brightness"),
        ('{"do": "set", "name": "period", "value": 9}', "set: value must be a whole number in 10..10000"),
        ('{"do": "blink", "port": "a", "seconds": 61}', "blink: seconds must be a whole number in 0..60"),
        ('{"do": "open", "cells": []}', "1 to 144 different places"),
        ('{"do": "open", "cells": [[0, 0], [0, 0]]}', "different places"),
        ('{"do": "open", "cells": [[0]]}', "[row, column] each"),
        ('{"do": "open", "cells": [[0, 0]], "faults": "loss=1"}', "must be a list"),
    ],
)
def test_what_is_wrong_is_said(text: str, words: str) -> None:
    with pytest.raises(ValueError) as refused:  # noqa: PT011 - the words are compared below
        parse_command(text)
    assert words in str(refused.value)


def test_there_is_an_end_to_length_depth_and_number() -> None:
    for text in (
        " " * (MAX_TEXT + 1),
        "[" * MAX_TEXT,
        '{"do":"put","row":' + "9" * 5000 + ',"col":0}',
        json.dumps({"do": "open", "cells": [[0, col] for col in range(-64, 64)] * 2}),
        json.dumps({"do": "arrange", "cells": [[r, c] for r in range(13) for c in range(MOST_TILES // 12)]}),
    ):
        with pytest.raises(ValueError, match=r"\w"):
            parse_command(text)


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=8,
)
FIELDS = sorted({name for kind in KINDS.values() for name in kind.__dataclass_fields__})


@given(st.dictionaries(st.sampled_from(FIELDS), json_values, max_size=5), st.sampled_from(sorted(KINDS)))
def test_any_object_is_a_command_within_its_bounds_or_refused(about: dict[str, Any], do: str) -> None:
    try:
        command = parse_command(json.dumps({"do": do, **about}))
    except ValueError:
        return
    assert isinstance(command, KINDS[do])
    for name, value in vars(command).items():
        kept = about.get(name, KINDS[do].__dataclass_fields__[name].default)
        if isinstance(kept, list):
            assert [list(item) if isinstance(item, tuple) else item for item in value] == kept
        else:
            assert value == kept


@given(st.text(max_size=60))
def test_any_text_is_a_command_or_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        parse_command(text)


def test_deeds_in_deeds_in_deeds_are_refused_before_they_are_read() -> None:
    text = '{"do":"open","cells":[[0,0]],"deeds":[[0,' * 300 + '{"do":"pull","port":"a"}' + "]]}" * 300
    with pytest.raises(ValueError, match="must be commands that change something, and open does not"):
        parse_command(text)
