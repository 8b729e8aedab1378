"""What a worker measures: blocks on the fast simulator and on emulated tiles."""

import math
import random

import numpy as np
import pytest

from support.sweeps import plan
from tilenca.base import paths
from tilenca.base.errors import BuildError
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.greeting import firmware_settings
from tilenca.model.file import load_model
from tilenca.shapes.batch import load_drawings
from tilenca.shapes.file import load_task
from tilenca.simulator import core_library
from tilenca.simulator.conditions import Conditions
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.simulator import Simulator
from tilenca.sweep.axes import EMULATOR, parse_axis, points
from tilenca.sweep.counts import Counts
from tilenca.sweep.measure import check_emulator, check_simulator, faults, measure_blocks, message_loss
from tilenca.sweep.plan import Plan

needs_core = pytest.mark.skipif(
    not core_library.LIBRARY.exists(), reason="run `make setup` to compile the core"
)
needs_elf = pytest.mark.skipif(
    not paths.FIRMWARE_ELF.exists(), reason="run `make setup` to build the firmware"
)


def totals(of: Plan) -> list[Counts]:
    blocks = [block for row in of.rows for block in row.blocks()]
    counts = measure_blocks(of.luggage, blocks).counts
    return [Counts.total(counts[block.key] for block in row.blocks()) for row in of.rows]


@needs_core
def test_the_numbers_are_those_of_the_simulator_under_the_same_conditions() -> None:
    (measured,) = totals(plan("loss=0.3", "dead=0.2", "ppm=20000", "boot-spread=0.4", only=("8",), runs=400))
    model = load_model(paths.DEFAULT_MODEL)
    drawings = load_drawings([paths.DEFAULT_SHAPES], labels=model.labels)
    conditions = Conditions("clock", loss=0.3, dead=0.2, drift=0.02, boot=20.0)
    simulator = Simulator(
        FastEngine(model), drawings, np.full(400, 8), conditions, np.random.default_rng(1), threads=1
    )
    trajectory = simulator.run(20)
    share = float((trajectory.right[-1] >= 1).mean())
    assert measured.right / 400 == pytest.approx(share, abs=4 * math.sqrt(0.25 / 400))
    assert measured.cells / 400 == pytest.approx(float(trajectory.right[-1].mean()), abs=0.1)
    assert measured.updates == pytest.approx(simulator.updates, rel=0.03)
    assert measured.right + measured.dash + measured.wrong + measured.split == measured.runs == 400


@needs_core
def test_results_do_not_depend_on_the_order_or_the_company_of_blocks() -> None:
    whole = plan("loss=0,0.4", only=("4", "7"), runs=3)
    blocks = [block for row in whole.rows for block in row.blocks()]
    shuffled = random.Random(1).sample(blocks, len(blocks))
    assert measure_blocks(whole.luggage, shuffled).counts == measure_blocks(whole.luggage, blocks).counts
    alone = plan("loss=0.4", only=("7",), runs=3)
    assert totals(alone)[0] == totals(whole)[-1]


@needs_core
@pytest.mark.parametrize(
    "axis",
    [
        "loss=0.9",
        "flip=0.02",
        "dead=0.5",
        "stuck=1",
        "schedule=listing",
        "lost=zero",
        "latency=0.95",
        "latency=tiles",
    ],
)
def test_each_axis_changes_what_happens(axis: str) -> None:
    more = ["loss=0.3"] if axis == "lost=zero" else []
    usual, other = (
        totals(plan(*more, only=("8",), runs=30))[0],
        totals(plan(axis, *more, only=("8",), runs=30))[0],
    )
    assert usual.converged != other.converged


@needs_core
def test_drawings_of_no_class_are_right_when_they_show_a_dash() -> None:
    (measured,) = totals(plan("drawings=unknown", runs=1, steps=60))
    assert measured.right > 0.5 * measured.runs
    assert measured.dash == 0


def test_inverted_bits_lose_the_frames_that_have_one() -> None:
    point = points([parse_axis("flip=0.001"), parse_axis("loss=0.5")], "fast")[0]
    assert message_loss(point, 21) == pytest.approx(1 - 0.5 * 0.999 ** (8 * 31))


@needs_elf
@pytest.mark.parametrize(("axis", "lost"), [("loss=0.3", 0.3), ("flip=0.002", 1 - 0.998 ** (8 * 31))])
def test_emulated_cables_lose_as_many_messages_as_the_axis_says(axis: str, lost: float) -> None:
    shape = load_task(paths.DEFAULT_SHAPES).find("8")
    point = points([parse_axis(axis)], EMULATOR)[0]
    specs = faults(point, 21, len(shape.cells), 1)
    settings = EmulationSettings(updates=60, boot_spread_s=0.0, faults=tuple(specs))
    emulation = Emulation(shape, ("8",), paths.FIRMWARE_ELF, settings, firmware_settings(paths.FIRMWARE_ELF))
    with emulation.array:
        emulation.run(lambda running, heard: None)
        frames = [tile["frames"] for tile in emulation.report(0.0)["tiles"]]
    # A tile sends to sides without a neighbour, too: three of four sides of an 8's 15 tiles have none.
    directions = 2 * len(emulation.cables)
    arrived = sum(each["received"] for each in frames) / (
        sum(each["sent"] for each in frames) * directions / (4 * len(shape.cells))
    )
    assert 1 - arrived == pytest.approx(lost, abs=0.04)


def test_dead_tiles_have_no_power_and_one_lives() -> None:
    point = points([parse_axis("dead=1")], EMULATOR)[0]
    dead = [spec.where for spec in faults(point, 21, 5, 3)]
    assert len(set(dead)) == 4
    assert faults(point, 21, 5, 3) == faults(point, 21, 5, 3)
    assert any(faults(point, 21, 5, seed) != faults(point, 21, 5, 3) for seed in range(9))


def test_what_a_worker_needs_is_looked_for_before_it_gets_work(monkeypatch: pytest.MonkeyPatch) -> None:
    check_simulator()
    check_emulator()
    monkeypatch.setattr(core_library, "library", lambda: (_ for _ in ()).throw(BuildError("none")))
    with pytest.raises(BuildError):
        check_simulator()
