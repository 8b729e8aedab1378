"""Named ways to train a model. A recipe is all that decides the result, beside the shapes and the seed."""

from dataclasses import dataclass, replace

from tilenca.errors import UsageError


@dataclass(frozen=True)
class Recipe:
    """How to train.

    A *round* is one step of training, in which some of the tiles update; rates are fractions 0..1.

    Attributes:
        iterations: optimiser steps.
        batch: drawings per optimiser step, those of the quiet pool included.
        rounds: least and most rounds per optimiser step.
        learning_rate: Adam's; `cosine` lets it fall to zero over the iterations.
        clip_norm: limit of the gradient's norm; 0: none.
        bounded: the tile's own arithmetic in the loop: clamped states and activations, byte messages.
        pool: tissues kept from one iteration to the next; 0: every sample starts from the seed state.
        reset: share of a batch taken back to the seed state.
        late: share of the samples taken back to the seed in which tiles are switched on one after the other;
            what the first ones make of it is not held against them, but they must get over it later.
        switch: share of a batch rebuilt into another drawing while running.
        quiet_pool: tissues left undisturbed for `quiet_rounds` rounds, so that nothing drifts; 0: none.
        quiet_batch: how many of them are in each batch.
        quiet_rounds: least and most rounds of an undisturbed life.
        quiet_penalty: weight of the squared change of settled states over one iteration.
        fire_rate: least and most share of tiles that update in a round, drawn for each sample.
        clocks: share of samples on the tiles' own clocks (fixed phase, own period, last message held).
        rounds_per_period: least and most rounds that one period of such a clock takes.
        drift: largest relative difference of a tile's period from the nominal one.
        latency: least and most delay of a message, in periods.
        lossy: share of samples that lose messages; a lost one reads as zero.
        max_loss: largest share of messages lost.
        validation_runs: runs of each drawing and schedule in the final measurement.
    """

    iterations: int
    batch: int
    rounds: tuple[int, int]
    learning_rate: float
    cosine: bool
    clip_norm: float
    bounded: bool
    pool: int = 0
    reset: float = 0.0
    late: float = 0.0
    switch: float = 0.0
    quiet_pool: int = 0
    quiet_batch: int = 0
    quiet_rounds: tuple[int, int] = (200, 4000)
    quiet_penalty: float = 0.0
    fire_rate: tuple[float, float] = (0.5, 0.5)
    clocks: float = 0.0
    rounds_per_period: tuple[float, float] = (2.0, 4.0)
    drift: float = 0.01
    latency: tuple[float, float] = (0.1, 0.9)
    lossy: float = 0.0
    max_loss: float = 0.0
    validation_runs: int = 50


# What real tiles need: nobody is reset, clocks differ, messages get lost, and the state must never drift.
DEFAULT = Recipe(
    iterations=18_000,
    batch=32,
    rounds=(14, 34),
    learning_rate=2e-3,
    cosine=True,
    clip_norm=1.0,
    bounded=True,
    pool=640,
    reset=0.15,
    late=0.5,
    switch=0.25,
    quiet_pool=128,
    quiet_batch=10,
    quiet_penalty=0.05,
    fire_rate=(0.3, 0.9),
    clocks=0.5,
    lossy=0.5,
    max_loss=0.3,
)

RECIPES: dict[str, Recipe] = {
    "default": DEFAULT,
    # As published: no pool, no limits, one sampler.
    "paper": Recipe(
        iterations=2_500,
        batch=128,
        rounds=(9, 29),
        learning_rate=1e-3,
        cosine=False,
        clip_norm=0.0,
        bounded=False,
    ),
    # Seconds long and of no use on tiles: shows that the whole chain works.
    "smoke": replace(
        DEFAULT,
        iterations=40,
        batch=8,
        rounds=(4, 8),
        pool=32,
        quiet_pool=8,
        quiet_batch=2,
        validation_runs=2,
    ),
}


def find_recipe(name: str) -> Recipe:
    """The recipe called `name`.

    Raises:
        UsageError: there is none; the message lists what there is.
    """
    if name not in RECIPES:
        raise UsageError(f"no recipe '{name}'; there are: {' '.join(RECIPES)}")
    return RECIPES[name]
