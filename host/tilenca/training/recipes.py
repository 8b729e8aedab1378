"""Named ways to train a model. A recipe is all that decides the result, beside the shapes and the seed."""

from dataclasses import dataclass, replace

from tilenca.base.errors import UsageError
from tilenca.evaluation.suites import Aims


@dataclass(frozen=True)
class Recipe:
    """How to train.

    A *round* is one step of training, in which some of the tiles update; rates are fractions 0..1.

    Attributes:
        hidden: width of both hidden layers, where `--hidden` does not say.
        seeds: trainings side by side, of which the best is kept, where `--seeds` does not say.
        iterations: optimiser steps.
        batch: drawings per optimiser step, those of the quiet pool included.
        rounds: least and most rounds per optimiser step; up to twice as many for large drawings.
        learning_rate: Adam's; it falls by the share `cosine` of it, along a cosine over the iterations.
        clip_norm: limit of the gradient's norm; 0: none.
        average: how much of the running mean of the weights, which is what is kept, stays in every iteration;
            0: the last weights are kept.
        bounded: the tile's own arithmetic in the loop: clamped states and activations, byte messages.
        pool: tissues kept from one iteration to the next; 0: every sample starts from the seed state.
        reset: share of what is not of the quiet pool that is taken back to the seed state.
        late: share of the samples taken back to the seed in which tiles are switched on one after the other;
            what the first ones make of it is not held against them, but they must get over it later.
        switch: share of it that is rebuilt into another drawing while running.
        scramble: share of it whose tiles get states of any others: from anywhere they must find back.
        away: share of it in which a tile or two are off for once; what the others make of it is not held
            against them.
        quiet_pool: tissues left undisturbed for `quiet_rounds` rounds, without losses: nothing may drift.
        quiet_batch: how many of them are in each batch.
        quiet_rounds: least and most rounds of an undisturbed life.
        ahead_every: iterations after which quiet tissues live ahead by the weights that are kept; 0: never.
        ahead: least and most steps that they then live.
        trials: of the files' drawings that then try each way to begin; the pool gets who does not agree.
        quiet_penalty: weight of the squared change of settled states over one iteration.
        fire_rate: least and most share of tiles that update in a round, drawn for each sample.
        clocks: share of samples on the tiles' own clocks (fixed phase, own period, last message held).
        rounds_per_period: least and most rounds that one period of such a clock takes.
        drift: largest relative difference of a tile's period from the nominal one.
        latency: least and most delay of a message, in periods.
        lossy: share of samples that lose messages; a lost one reads as zero.
        max_loss: largest share of messages lost.
        longest_loss: most rounds that the loss of a neighbour's messages lasts.
        unheard: share of samples in which what a tile sends is now and then heard by nobody; its neighbours
            go on with what they heard before.
        max_unheard: largest share of messages that nobody hears.
        stretch: largest factor by which drawings are stretched, where the shape file has sizes; 1: not.
        stretched: share of stretched drawings among the tissues.
        damaged: share of drawings with one tile missing.
        unknown: share of drawings of no class, whose tiles learn to show a dash.
        ramp: between these shares of the iterations damaged and unknown drawings grow to their full share.
        hard: how much of the choice of drawings goes by how often each failed lately.
        check_every: iterations from one short measurement to the next; training ends early when all targets
            hold in several of them; 0: never.
        validation_runs: runs of each drawing in the final measurement.
    """

    hidden: int
    iterations: int
    batch: int
    rounds: tuple[int, int]
    learning_rate: float
    cosine: float
    clip_norm: float
    bounded: bool
    seeds: int = 1
    average: float = 0.0
    pool: int = 0
    reset: float = 0.0
    late: float = 0.0
    switch: float = 0.0
    scramble: float = 0.0
    away: float = 0.0
    quiet_pool: int = 0
    quiet_batch: int = 0
    quiet_rounds: tuple[int, int] = (200, 4000)
    ahead_every: int = 0
    ahead: tuple[int, int] = (50, 3000)
    trials: int = 300
    quiet_penalty: float = 0.0
    fire_rate: tuple[float, float] = (0.5, 0.5)
    clocks: float = 0.0
    rounds_per_period: tuple[float, float] = (2.0, 4.0)
    drift: float = 0.01
    latency: tuple[float, float] = (0.1, 0.9)
    lossy: float = 0.0
    max_loss: float = 0.0
    longest_loss: int = 1
    unheard: float = 0.0
    max_unheard: float = 0.0
    stretch: float = 1.0
    stretched: float = 0.0
    damaged: float = 0.0
    unknown: float = 0.0
    ramp: tuple[float, float] = (0.0, 0.0)
    hard: float = 0.0
    check_every: int = 0
    validation_runs: int = 100


# What real tiles need: nobody is reset, clocks differ, messages and tiles get lost, states never drift,
# and a shape that is none of the task's must not be taken for one.
FULL = Recipe(
    hidden=96,
    iterations=40_000,
    batch=32,
    rounds=(14, 34),
    learning_rate=1e-3,
    cosine=0.9,
    clip_norm=1.0,
    average=0.9995,
    bounded=True,
    pool=640,
    reset=0.15,
    late=0.5,
    switch=0.3,
    scramble=0.05,
    away=0.1,
    quiet_pool=128,
    quiet_batch=12,
    quiet_rounds=(200, 20_000),
    ahead_every=500,
    quiet_penalty=0.05,
    fire_rate=(0.3, 0.9),
    clocks=0.5,
    lossy=0.5,
    max_loss=0.3,
    longest_loss=3,
    unheard=0.5,
    max_unheard=0.7,
    stretch=10.0,
    stretched=0.28,
    damaged=0.2,
    unknown=0.27,
    ramp=(0.05, 0.2),
    hard=0.6,
    check_every=4_000,
    validation_runs=500,
)

RECIPES: dict[str, Recipe] = {
    "full": FULL,
    # For trying out drawings: three sizes, no damage, no unknown drawings.
    "quick": replace(
        FULL,
        hidden=64,
        iterations=12_000,
        stretch=1.5,
        stretched=0.4,
        damaged=0.0,
        unknown=0.0,
        check_every=1_000,
        validation_runs=100,
    ),
    # As published: no pool, no limits, one sampler.
    "paper": Recipe(
        hidden=40,
        iterations=2_500,
        batch=128,
        rounds=(9, 29),
        learning_rate=1e-3,
        cosine=0.0,
        clip_norm=0.0,
        bounded=False,
    ),
    # Seconds long and of no use on tiles: shows that the whole chain works.
    "smoke": replace(
        FULL,
        hidden=40,
        seeds=1,
        iterations=40,
        batch=8,
        rounds=(4, 8),
        pool=32,
        quiet_pool=8,
        quiet_batch=2,
        ahead_every=15,
        ahead=(5, 20),
        trials=5,
        stretch=1.5,
        check_every=20,
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


def aims_of(recipe: Recipe) -> Aims:
    """What a recipe trains for."""
    return Aims(recipe.stretch, recipe.damaged > 0, recipe.unknown > 0)
