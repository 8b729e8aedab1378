"""How long the steps of `tilenca make` will take: from the work there is, and this machine's pace now."""

import argparse
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tilenca.base import paths
from tilenca.base.errors import TilencaError
from tilenca.base.sides import EAST, WEST
from tilenca.commands.train_plan import TrainingPlan
from tilenca.commands.train_steps import at_once, jobs_of
from tilenca.emulator.array import Array
from tilenca.emulator.side_by_side import at_once as side_by_side
from tilenca.evaluation.suites import Suite
from tilenca.evaluation.workload import work_of
from tilenca.model import cost
from tilenca.model.file import Model
from tilenca.shapes.batch import Drawings
from tilenca.simulator.conditions import Conditions
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.simulator import Simulator

if TYPE_CHECKING:
    from tilenca.training.runner import Job

TIMED_STEPS, TIMED_S = 3, 2.0  # at least so many iterations are timed, and for at least so long
PROBE_UPDATES, PROBE_STEPS, PROBE_S = 60_000, 30, 0.5  # of tiles at once, and for at least how long
# Processor time on one machine (a Xeon of 2.0 to 3.0 GHz), of which this one is faster or slower.
S_PER_MAC = 0.062e-9
ROW_S = 0.02  # of a measurement, beside the updates of its tiles
COLD_BUILD_S, WARM_BUILD_S = 5.0, 2.0
EMULATE_S, TILE_SECOND_S = 2.0, 0.023  # to lay out and report; an emulated second of a tile
EMULATED_S = 2.6  # until the tiles of a drawing agree, the bootloader's second included
TALKING_S, TIMED_TILES_S = 0.1, 0.2  # two emulated tiles talk by then, and are timed for so long


@dataclass(frozen=True)
class Pace:
    """How fast this machine is now.

    Attributes:
        update_s: seconds for one update of one tile, when many are computed.
        factor: seconds for a second of processor time on the machine of the constants, by all processors.
    """

    update_s: float
    factor: float


def pace_of(model: Model, drawings: Drawings) -> Pace:
    """Measures the pace with a model, which need not be trained."""
    random = np.random.default_rng(0)
    count = max(1, PROBE_UPDATES // PROBE_STEPS // max(1, int(np.mean(drawings.sizes))))
    chosen = np.resize(np.arange(len(drawings)), count)
    simulator = Simulator(FastEngine(model), drawings, chosen, Conditions("clock"), random)
    began_s, updates = time.perf_counter(), 0
    while (passed_s := time.perf_counter() - began_s) < PROBE_S:
        simulator.run(PROBE_STEPS)
        updates += simulator.cells * PROBE_STEPS
    update_s = passed_s / updates
    return Pace(update_s, update_s / (cost.macs(model.dimensions) * S_PER_MAC))


def measuring_s(model: Model, suite: Suite, runs: int, pace: Pace) -> float:
    """How long it takes to measure such a model, the making of the suite left out."""
    work = work_of(FastEngine(model), suite, runs)
    return work.updates * pace.update_s + work.rows * ROW_S * pace.factor


def building_s(args: argparse.Namespace, pace: Pace) -> float:
    """How long it takes to build the firmware: little where it was built in this folder before."""
    is_warm = paths.model_elf(args.out).exists()
    return (WARM_BUILD_S if is_warm else COLD_BUILD_S) * pace.factor


def emulating_s(args: argparse.Namespace, plan: TrainingPlan, pace: Pace) -> float:
    """How long it takes to emulate every drawing of the file until its tiles agree."""
    tile_s = None if (timed := _tile_second_s(args)) is None else timed / side_by_side(len(plan.task))
    of_a_tile = TILE_SECOND_S * pace.factor if tile_s is None else tile_s
    return EMULATE_S * pace.factor + EMULATED_S * int(plan.task.sizes.sum()) * of_a_tile


def _tile_second_s(args: argparse.Namespace) -> float | None:
    """How long an emulated second of one tile takes, by two that talk; None: there is no firmware yet.

    Tiles that talk cost the most, so the estimate is rather too long: in the bootloader's second they idle.
    """
    images = paths.model_elf(args.out), paths.firmware_elf()
    image = next((image for image in images if image.exists()), None)
    if image is None:
        return None
    with suppress(TilencaError), Array(image, 2, [(0, EAST, 1, WEST)], translated=False) as array:
        array.run(TALKING_S)
        began_s = time.perf_counter()
        array.run(TIMED_TILES_S)
        return (time.perf_counter() - began_s) / (2 * TIMED_TILES_S)
    return None


def training_s(args: argparse.Namespace, plan: TrainingPlan) -> tuple[float, Model]:
    """How long the training takes at most, from some iterations; and a model as it is after these.

    The training goes on from a checkpoint after these (`args.resume`), to the same bytes.
    A training with `--force` begins anew.

    Raises:
        UsageError: a checkpoint is of no use.
    """
    from tilenca.training.runner import make_trainer
    from tilenca.training.trainer import model_of

    jobs = jobs_of(args, plan)
    left = [_left(job) for job in jobs]
    job = jobs[left.index(max(left))]
    trainer = make_trainer(job)
    before = trainer.iteration
    if max(left) <= TIMED_STEPS:
        return 0.0, model_of(trainer.now(), {})[0]
    trainer.step()  # the first one takes longer
    began_s, done, every = time.perf_counter(), 0, plan.recipe.check_every
    while (passed_s := time.perf_counter() - began_s) < TIMED_S or done < TIMED_STEPS:
        if trainer.iteration == trainer.config.recipe.iterations - 1:
            break
        if every and (trainer.iteration + 1) % every == 0 and done:
            break  # the training itself measures there
        trainer.step()
        done += 1
    each_s = passed_s / max(done, 1)
    if not args.force and (not every or trainer.iteration // every == before // every):
        trainer.save(job.checkpoint)
        args.resume = True
    return each_s * _longest(left, at_once(args, plan)), model_of(trainer.now(), {})[0]


def _left(job: "Job") -> int:
    """How many iterations there are still to do.

    Raises:
        UsageError: the checkpoint is of no use.
    """
    from tilenca.training.trainer import trained_at

    iterations = job.config.recipe.iterations
    if not (job.resume and job.checkpoint.exists()):
        return iterations
    trained = trained_at(job.checkpoint, job.config)
    return 0 if trained.done else iterations - trained.iteration


def _longest(jobs: Sequence[int], at_once: int) -> int:
    """When the last job ends, if so many run at once and each begins as soon as there is room."""
    ends = [0] * at_once
    for job in jobs:
        ends[ends.index(min(ends))] += job
    return max(ends)
