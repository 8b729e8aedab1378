"""Every function of the rollout kernel's C interface that is called with what cannot be, and says so."""

import math
from typing import Any

import pytest

from support.c_structures import Structures
from tilenca.base import native_library

INT_MAX = 2**31 - 1
CELLS, CHANNELS, HIDDEN, ROW = 2, 2, 3, 16


class Given(Structures):
    """Two cells that update in one tick of two; single fields can be given another value."""

    def __init__(self) -> None:
        super().__init__("rollout")
        sizes = {"w1": HIDDEN * 5 * CHANNELS, "w2": HIDDEN * HIDDEN, "w3": CHANNELS * HIDDEN}
        sizes |= {"b1": HIDDEN, "b2": HIDDEN, "b3": CHANNELS}
        self.network_fields: dict[str, Any] = {"channels": CHANNELS, "hidden1": HIDDEN, "hidden2": HIDDEN}
        self.network_fields |= {"rounded": 1, "limit": 127.0}
        self.network_fields |= {name: self.array("float", [0.5] * size) for name, size in sizes.items()}
        self.schedule_fields: dict[str, Any] = {
            "cells": CELLS,
            "ticks": 2,
            "counts": self.array("int64_t", [0, 2]),
            "updating": self.array("int32_t", [0, 1]),
            "perceived": self.array("int32_t", [0, 3, 4, 4, 4, 1, 4, 4, 4, 2]),
            "delivered": self.array("uint8_t", [0, 0, 1, 1]),
        }
        self.state = self.array("float", [1.0] * CELLS * CHANNELS)

    def network(self, **other: Any) -> Any:
        return self.made("tilenca_rollout_network", self.network_fields, other)

    def schedule(self, **other: Any) -> Any:
        return self.made("tilenca_rollout_schedule", self.schedule_fields, other)

    def tape(self, **other: Any) -> Any:
        rows = {
            name: self.array("float", [0.0] * 2 * ROW) for name in ("inputs", "hidden1", "hidden2", "after")
        }
        return self.made("tilenca_rollout_tape", rows, other)


@pytest.fixture
def given() -> Given:
    return Given()


def both_fail(
    given: Given, network: Any, schedule: Any, state: Any, tape: Any, gradients: Any = None
) -> None:
    """Forward and backward must fail, with words of their own."""
    tapes = {"forward": [tape], "backward": [tape, given.tape() if gradients is None else gradients]}
    for function, places in tapes.items():
        call = getattr(given.lib, f"tilenca_rollout_{function}")
        assert call(given.null, given.null, given.null, *[given.null] * len(places)) == -1
        assert given.library.last_error() == "the network is null"
        assert call(network, schedule, state, *places) == -1
        assert given.library.last_error() != "the network is null"
        assert "\n" not in given.library.last_error()


def test_what_is_right_runs(given: Given) -> None:
    tape = given.tape()
    assert given.lib.tilenca_rollout_forward(given.network(), given.schedule(), given.state, tape) == 0
    assert all(math.isfinite(value) for value in given.state)
    backward = given.lib.tilenca_rollout_backward
    assert backward(given.network(), given.schedule(), given.state, tape, given.tape(inputs=given.null)) == 0


BAD_NETWORKS: list[dict[str, Any]] = [
    *({name: size} for name in ("channels", "hidden1", "hidden2") for size in (0, -1, INT_MAX, -INT_MAX - 1)),
    *({name: None} for name in ("w1", "b1", "w2", "b2", "w3", "b3")),
]


@pytest.mark.parametrize("other", BAD_NETWORKS, ids=str)
def test_a_network_that_cannot_be(given: Given, other: dict[str, Any]) -> None:
    both_fail(given, given.network(**other), given.schedule(), given.state, given.tape())


BAD_SCHEDULES: list[dict[str, Any]] = [
    *({name: number} for name in ("cells", "ticks") for number in (-1, -INT_MAX - 1)),
    {"cells": INT_MAX},
    {"cells": 1},
    *({"counts": counts} for counts in ([3, 0], [-1, 2], [0, 2**62], None)),
    *({"updating": [0, cell]} for cell in (-1, 2, INT_MAX, -INT_MAX - 1)),
    *({"perceived": [0] * 9 + [row]} for row in (-1, 5, INT_MAX, -INT_MAX - 1)),
    *({name: None} for name in ("updating", "perceived", "delivered")),
]


@pytest.mark.parametrize("other", BAD_SCHEDULES, ids=str)
def test_a_schedule_that_cannot_be(given: Given, other: dict[str, Any]) -> None:
    both_fail(given, given.network(), given.schedule(**other), given.state, given.tape())


def test_arrays_and_structures_that_are_missing(given: Given) -> None:
    network, schedule, tape = given.network(), given.schedule(), given.tape()
    both_fail(given, network, given.null, given.state, tape)
    both_fail(given, network, schedule, given.null, tape)
    both_fail(given, network, schedule, given.state, given.null)
    for name in ("hidden1", "hidden2", "after"):
        both_fail(given, network, schedule, given.state, given.tape(**{name: given.null}))
    forward, backward = given.lib.tilenca_rollout_forward, given.lib.tilenca_rollout_backward
    assert forward(network, schedule, given.state, given.tape(inputs=given.null)) == -1
    assert backward(network, schedule, given.state, tape, given.null) == -1
    for name in ("hidden1", "hidden2", "after"):
        assert backward(network, schedule, given.state, tape, given.tape(**{name: given.null})) == -1


def test_no_function_is_left_out() -> None:
    """A new one fails this test until it is tested above."""
    functions = {name for name in dir(native_library.load("rollout").lib) if name.startswith("tilenca_")}
    assert {name.removeprefix("tilenca_rollout_") for name in functions} == {
        "abi_version", "size_of", "last_error", "kind", "forward", "backward",
    }  # fmt: skip
