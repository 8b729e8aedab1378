"""Conditions that make no sense are refused."""

from typing import Any

import pytest

from support.restless_grids import TILES
from tilenca.simulator.conditions import Conditions, Fault


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"loss": 1.5}, "shares"),
        ({"dead": -0.1}, "shares"),
        ({"schedule": "often"}, "no such schedule"),
        ({"lost": "found"}, "no such schedule"),
        ({"latency": (0.0, 0.5)}, "arrives before"),
        ({"latency": (0.5, 0.4)}, "arrives before"),
        ({"drift": 0.2}, "arrives before"),
        ({"drift": -0.1}, "arrives before"),
        ({"boot": -1.0}, "arrives before"),
        ({"boot": float("nan")}, "arrives before"),
    ],
)
def test_conditions_that_make_no_sense_are_refused(settings: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Conditions(**settings)


@pytest.mark.parametrize(
    "settings",
    [
        {"kind": "tired"},
        {"kind": "dead", "begin": -1},
        {"kind": "dead", "end": 4},
        {"kind": "away"},
        {"kind": "away", "begin": 4, "end": 4},
    ],
)
def test_faults_that_make_no_sense_are_refused(settings: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="fault"):
        Fault(tiles=TILES, **settings)
