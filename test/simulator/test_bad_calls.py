"""Every function of the simulator's C interface that is called with what cannot be, and says so."""

import subprocess
import sys
from typing import Any

import pytest

from support.c_structures import Structures
from tilenca.base import native_library

UNITS = 65536
STEP = 20 * UNITS
INT_MAX = 2**31 - 1


class Given(Structures):
    """Two runs of two cells each, and a small model; single fields can be given another value."""

    def __init__(self) -> None:
        super().__init__("simulator")
        self.model_fields: dict[str, Any] = {
            "channels": 4, "hidden1": 3, "hidden2": 2, "classes": 2,
            "w1": self.array("int8_t", [1] * 60), "b1": self.array("int16_t", [0] * 3),
            "w2": self.array("int8_t", [1] * 6), "b2": self.array("int16_t", [0] * 2),
            "w3": self.array("int8_t", [1] * 8), "b3": self.array("int16_t", [0] * 4),
        }  # fmt: skip
        self.setup_fields: dict[str, Any] = {
            "runs": 2, "cells": 4, "loss": 2**31, "schedule": 1, "start": 0, "fault": 3, "begin": 1, "end": 2,
            "changes_count": 2, "changes": self.array("tilenca_change", [(0, 1, 0), (3, 1, 1)]),
            "starts": self.array("int32_t", [0, 2, 4]),
            "neighbours": self.array("int32_t", [4, 1, 4, 4, 4, 4, 4, 0, 4, 3, 4, 4, 4, 4, 4, 2]),
            "alive": self.array("uint8_t", [1] * 4),
            "target": self.array("int8_t", [0, 1, 0, 1]),
            "seeds": self.array("uint64_t", [1, 2]),
            "first": self.array("int64_t", [UNITS] * 4),
            "period": self.array("int64_t", [20 * UNITS] * 4),
            "latency": self.array("int64_t", [UNITS] * 16),
            "seed_latency": self.array("int64_t", [UNITS] * 16),
            "line": self.array("int64_t", [UNITS] * 4),
            "faulty": self.array("int32_t", [1, -1]),
        }  # fmt: skip
        self.states = self.array("int16_t", [0] * 16)
        self.shown = self.array("int8_t", [-1] * 4)
        self.right = self.array("float", [0.0] * 20)

    def model(self, **other: Any) -> Any:
        return self.made("tilenca_model", self.model_fields, other)

    def setup(self, **other: Any) -> Any:
        return self.made("tilenca_setup", self.setup_fields, other)

    def batch(self, model: Any, setup: Any) -> Any:
        return self.lib.tilenca_grid_batch_new(model, setup, self.states, self.shown)


@pytest.fixture
def given() -> Given:
    return Given()


def fails(given: Given, function: str, *arguments: Any) -> str:
    """The call must fail, with words of its own, which it returns."""
    assert given.lib.tilenca_schedule_next(given.null, given.null) < 0
    before = given.library.last_error()
    result = getattr(given.lib, f"tilenca_{function}")(*arguments)
    assert result == given.null if isinstance(result, given.ffi.CData) else result < 0, function
    words = given.library.last_error()
    assert words != before
    assert words
    assert "\n" not in words
    return words


BAD_MODELS: list[dict[str, Any]] = [
    *({"channels": width} for width in (0, 52, 255)),
    *({layer: width} for layer in ("hidden1", "hidden2") for width in (0, 128, 255)),
    *({"classes": classes} for classes in (0, 5, 255)),
    *({f"{kind}{layer}": None} for kind in "wb" for layer in (1, 2, 3)),
]


@pytest.mark.parametrize("other", BAD_MODELS, ids=str)
def test_a_model_that_cannot_be(given: Given, other: dict[str, Any]) -> None:
    model = given.model(**other)
    fails(given, "grid_batch_new", model, given.setup(), given.states, given.shown)
    fails(given, "update_cells", model, given.states, given.shown, 1, 0)
    fails(given, "update_cells", model, given.states, given.shown, 1, 1)


BAD_SETUPS: list[dict[str, Any]] = [
    *({name: number} for name in ("runs", "cells") for number in (-1, -INT_MAX - 1, INT_MAX)),
    *({"starts": starts} for starts in ([0, 2, 3], [1, 2, 4], [0, 5, 4], [0, -1, 4], [0, 2, INT_MAX], None)),
    *({"neighbours": [4, other] + [4] * 14} for other in (-1, 2, 5, INT_MAX, -INT_MAX - 1)),
    *(
        {name: None}
        for name in ("neighbours", "alive", "seeds", "first", "period", "latency", "faulty", "changes")
    ),
    {"loss": 2**32 + 1},
    {"loss": 2**64 - 1},
    *({"fault": fault} for fault in (4, 255)),
    *({"schedule": schedule} for schedule in (3, 255)),
    *({"changes_count": count} for count in (-1, -INT_MAX - 1)),
    *(
        {"changes": changes}
        for changes in (
            [(-1, 1, 0), (3, 1, 1)],
            [(3, 1, 0), (2, 1, 1)],
            [(0, -1, 0), (3, 1, 1)],
            [(0, 4, 0), (3, 1, 1)],
            [(0, 1, 2), (3, 1, 1)],
            [(0, 1, 0), (3, 1, -1)],
        )
    ),
    *({"faulty": faulty} for faulty in ([2, -1], [-2, -1], [1, 1], [1, 4], [INT_MAX, -1])),
    *({"start": start} for start in (1, UNITS, -1, -UNITS - 1, -(2**62), -STEP * 1_000_001)),
    *({"first": [first] * 4} for first in (2**60, -(2**60))),
    *({"period": [period] * 4} for period in (0, -1, 2**60)),
    *(
        {name: [UNITS] * 15 + [latency]}
        for name in ("latency", "seed_latency")
        for latency in (20 * UNITS, -1, 2**62)
    ),
    *({"line": [0] * 3 + [line]} for line in (-1, 2**62)),
]


@pytest.mark.parametrize("other", BAD_SETUPS, ids=str)
def test_a_setup_that_cannot_be(given: Given, other: dict[str, Any]) -> None:
    setup = given.setup(**other)
    fails(given, "schedule_new", setup)
    fails(given, "grid_batch_new", given.model(), setup, given.states, given.shown)


def test_tiles_that_were_switched_on_a_thousand_million_seconds_ago_are_refused(given: Given) -> None:
    """Every tick before the first step is run, so that a mistake would never end."""
    for start in (-1_000_001, -(10**9) * 50):  # a step takes 20 ms
        words = fails(given, "schedule_new", given.setup(start=start * STEP))
        assert "the start is" in words
        assert f"{-1_000_000 * STEP} to 0" in words
    for missing in ("seed_latency", "line"):
        schedule = given.lib.tilenca_schedule_new(given.setup(**{missing: None}))
        assert schedule != given.null
        given.lib.tilenca_schedule_free(schedule)


def test_arrays_and_structures_that_are_missing(given: Given) -> None:
    model, setup, null = given.model(), given.setup(), given.null
    fails(given, "grid_batch_new", null, setup, given.states, given.shown)
    fails(given, "grid_batch_new", model, null, given.states, given.shown)
    fails(given, "grid_batch_new", model, setup, null, given.shown)
    fails(given, "grid_batch_new", model, setup, given.states, null)
    fails(given, "grid_batch_new", model, given.setup(target=null), given.states, given.shown)
    fails(given, "schedule_new", null)
    fails(given, "update_cells", null, given.states, given.shown, 1, 0)
    fails(given, "update_cells", model, null, given.shown, 1, 0)
    fails(given, "update_cells", model, given.states, null, 1, 0)


def test_a_run_that_cannot_be(given: Given) -> None:
    batch = given.batch(given.model(), given.setup())
    assert batch != given.null
    fails(given, "grid_batch_run", given.null, 1, 1, given.right, given.null)
    fails(given, "grid_batch_run", batch, 1, 1, given.null, given.null)
    for steps, threads in ((-1, 1), (-INT_MAX - 1, 1), (1, 0), (1, -1)):
        assert "number of" in fails(given, "grid_batch_run", batch, steps, threads, given.right, given.null)
    assert given.lib.tilenca_grid_batch_updates(batch) == 0
    assert given.lib.tilenca_grid_batch_run(batch, 1, INT_MAX, given.right, given.null) == 0
    assert given.lib.tilenca_grid_batch_updates(batch) > 0
    given.lib.tilenca_grid_batch_free(batch)


def test_what_null_is_allowed_for(given: Given) -> None:
    given.lib.tilenca_grid_batch_free(given.null)
    given.lib.tilenca_schedule_free(given.null)
    assert given.lib.tilenca_grid_batch_updates(given.null) == 0
    assert given.lib.tilenca_update_cells(given.model(), given.null, given.null, 0, 1) == 0


def test_a_tick_needs_a_schedule_and_a_place(given: Given) -> None:
    schedule, tick = given.lib.tilenca_schedule_new(given.setup()), given.ffi.new("tilenca_tick*")
    assert given.lib.tilenca_schedule_next(schedule, given.null) < 0
    assert "place for the tick" in given.library.last_error()
    assert given.lib.tilenca_schedule_next(given.null, tick) < 0
    assert "schedule is null" in given.library.last_error()
    assert given.lib.tilenca_schedule_next(schedule, tick) == 0
    given.lib.tilenca_schedule_free(schedule)


def test_no_function_is_left_out() -> None:
    """A new one fails this test until it is tested above."""
    functions = {name for name in dir(native_library.load("simulator").lib) if name.startswith("tilenca_")}
    assert {name.removeprefix("tilenca_") for name in functions} == {
        "simulator_abi_version", "simulator_size_of", "simulator_last_error", "update_cells",
        "grid_batch_new", "grid_batch_free", "grid_batch_run", "grid_batch_updates",
        "schedule_new", "schedule_free", "schedule_next",
    }  # fmt: skip


FEW_THREADS = """
import resource
from tilenca.base import native_library
library = native_library.load("simulator")
ffi, lib = library.ffi, library.lib
CELLS = 1 << 14
new = ffi.new
arrays = {
    "starts": new("int32_t[]", list(range(CELLS + 1))), "neighbours": new("int32_t[]", [CELLS] * 4 * CELLS),
    "alive": new("uint8_t[]", [1] * CELLS), "target": new("int8_t[]", CELLS),
    "seeds": new("uint64_t[]", list(range(CELLS))),
}
weights = [new("int8_t[]", 5), new("int16_t[]", 1)] * 3
setup = new("tilenca_setup*", {"runs": CELLS, "cells": CELLS} | arrays)
model = new("tilenca_model*", (1, 1, 1, 1, *weights))
states, shown = new("int16_t[]", CELLS), new("int8_t[]", CELLS)
right = new("float[]", CELLS)
batch = library.call("grid_batch_new", model, setup, states, shown)
pages = int(open("/proc/self/statm").read().split()[0])
limit = pages * resource.getpagesize() + 4 * 2**20  # less than the stack of one thread
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
library.call("grid_batch_run", batch, 1, 8, right, ffi.NULL)
print(library.call("grid_batch_updates", batch))
"""


def test_threads_that_the_machine_does_not_give_are_done_without() -> None:
    command = [sys.executable, "-c", FEW_THREADS]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert 0.9 < int(done.stdout) / (1 << 14) < 1.1  # each cell updates once a step, on average
