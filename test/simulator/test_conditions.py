"""Conditions that make no sense are refused."""

from typing import Any

import pytest

from support.restless_grids import TILES
from tilenca.simulator.conditions import Conditions, Fault, parse_latency


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


@pytest.mark.parametrize(
    ("text", "latency"), [("0.5", (0.5, 0.5)), ("0.1-0.9", (0.1, 0.9)), ("0.98", (0.98, 0.98))]
)
def test_a_latency_is_one_number_of_periods_or_two(text: str, latency: tuple[float, float]) -> None:
    assert parse_latency(text) == latency


@pytest.mark.parametrize("text", ["", "0", "soon", "0.5-", "0.9-0.1", "-0.5", "0.5-1", "nan", "0.1-0.2-0.3"])
def test_other_latencies_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="periods"):
        parse_latency(text)
