"""Named ways to train a model. Recipe, shapes and seed alone decide the result."""

from dataclasses import dataclass, replace

from tilenca.base.errors import UsageError
from tilenca.base.suggest import did_you_mean
from tilenca.evaluation.suites import Aims
from tilenca.model.file import DEFAULT_HIDDEN


@dataclass(frozen=True)
class Recipe:
    """How to train.

    A *tick* is one step of a rollout, in which some of the tiles update; rates are fractions 0..1.

    Attributes:
        hidden: width of both hidden layers, unless `--hidden` says otherwise.
        seeds: trainings side by side, unless `--seeds` says otherwise; the best is kept.
        iterations: optimiser steps.
        batch: drawings per optimiser step, those of the undisturbed pool included.
        ticks: least and most ticks of a rollout; up to twice as many for large drawings.
        learning_rate: Adam's; it falls by the share `cosine` of it, along a cosine over the iterations.
        clip_norm: limit of the gradient's norm; 0: none.
        ema_decay: decay per iteration of the exponential moving average (EMA) of the weights, which becomes
            the model; 0: the last weights become the model.
        quantisation_aware: train with the tile's own arithmetic: clamped states and activations, byte
            messages.
        perturbed_pool: grids whose rollouts go on in the next iteration; 0: every sample starts from the seed
            state.
        reset: share of the perturbed samples that start anew from the seed state.
        staggered_start: share of the samples that start anew in which tiles are switched on one after the
            other; their first results do not count, but later ones must be right.
        switch: share of the perturbed samples that are rebuilt into another drawing while running.
        settled: share of those that were undisturbed for long before: they must let go of an old answer.
        state_shuffle: share of the perturbed samples whose tiles get states of any other tiles; the network
            learns to recover from arbitrary states.
        away: share of the perturbed samples in which a tile or two are off for once; the results of the other
            tiles do not count.
        undisturbed_pool: grids left undisturbed for `undisturbed_ticks` ticks, without losses: nothing may
            drift.
        undisturbed_batch: how many of them are in each batch.
        undisturbed_ticks: least and most ticks of an undisturbed grid, until it starts anew.
        refresh_every: iterations after which the undisturbed grids run long rollouts with the EMA weights; 0:
            never.
        refresh_steps: least and most steps of those rollouts.
        mine_every: iterations after which hard examples are mined and drawings renewed; 0: never.
        trials: drawings of the files to try with each kind of beginning, to mine hard examples: those that do
            not agree go into the perturbed pool.
        stability_penalty: weight of the squared change of converged states over one iteration.
        loss_limit: the most that one cell can add to the loss, in units of the squared error; 0: any.
        limited_from: share of the iterations after which that limit holds; before, nothing may be given up.
        fire_rate: least and most share of tiles that update in a tick, drawn for each sample.
        clocks: share of samples on the tiles' own clocks (fixed phase, own period, last message held).
        ticks_per_period: least and most ticks that one period of such a clock takes.
        drift: largest relative difference of a tile's period from the nominal one.
        latency: least and most delay of a message, in periods.
        lossy: share of samples that lose messages; a lost one reads as zero.
        max_loss: largest share of messages lost.
        longest_loss: most ticks that the loss of a neighbour's messages lasts.
        stale: share of samples in which all neighbours of a tile miss a message now and then; they go on with
            the stale message before it.
        max_stale: largest share of messages that all neighbours miss.
        library: drawings that are drawn by chance and renewed, of all kinds together.
        renewed: share of them that is renewed whenever hard examples are mined.
        varied: share of variants of the classes, where the shape file has `[vary]`.
        unlabelled: share of drawings whose class is in doubt: their tiles must agree on any answer.
        stretch: largest factor by which drawings are stretched, where the shape file has sizes; 1: not.
        stretched: share of stretched drawings among the grids.
        damaged: share of drawings with tiles missing.
        unknown: share of drawings of no class, whose tiles learn to show a dash.
        ramp: between these shares of the iterations the drawings that are renewed grow to their full share;
            training begins with those of the files and the stretched ones.
        failure_weighting: share of failure-weighted sampling: how much the choice of drawings depends on how
            often each failed lately.
        directions: weight of the error of four more scores, which say on which side of a tile another one is
            missing; 0: the model has none.
        one_tile: share of the rebuilt grids that get just one tile less, or that one back.
        check_every: iterations from one short measurement to the next; training ends early when all targets
            hold in several of them; 0: never, the last weights become the model.
        validation_runs: runs of each drawing in the final measurement.
    """

    hidden: int
    iterations: int
    batch: int
    ticks: tuple[int, int]
    learning_rate: float
    cosine: float
    clip_norm: float
    quantisation_aware: bool
    seeds: int = 1
    ema_decay: float = 0.0
    perturbed_pool: int = 0
    reset: float = 0.0
    staggered_start: float = 0.0
    switch: float = 0.0
    settled: float = 0.0
    state_shuffle: float = 0.0
    away: float = 0.0
    undisturbed_pool: int = 0
    undisturbed_batch: int = 0
    undisturbed_ticks: tuple[int, int] = (200, 4000)
    refresh_every: int = 0
    refresh_steps: tuple[int, int] = (50, 3000)
    mine_every: int = 0
    trials: int = 300
    stability_penalty: float = 0.0
    loss_limit: float = 0.0
    limited_from: float = 0.5
    fire_rate: tuple[float, float] = (0.5, 0.5)
    clocks: float = 0.0
    ticks_per_period: tuple[float, float] = (2.0, 4.0)
    drift: float = 0.01
    latency: tuple[float, float] = (0.1, 0.9)
    lossy: float = 0.0
    max_loss: float = 0.0
    longest_loss: int = 1
    stale: float = 0.0
    max_stale: float = 0.0
    library: int = 6000
    renewed: float = 0.2
    varied: float = 0.0
    unlabelled: float = 0.0
    stretch: float = 1.0
    stretched: float = 0.0
    damaged: float = 0.0
    unknown: float = 0.0
    ramp: tuple[float, float] = (0.0, 0.0)
    failure_weighting: float = 0.0
    directions: float = 0.0
    one_tile: float = 0.0
    check_every: int = 0
    validation_runs: int = 100


# For real tiles: no tile is reset, clocks differ, messages and tiles get lost, states must not drift, and
# tiles must not name a shape that is none of the task's.
FULL = Recipe(
    hidden=DEFAULT_HIDDEN,
    iterations=40_000,
    batch=32,
    ticks=(14, 34),
    learning_rate=1e-3,
    cosine=0.9,
    clip_norm=1.0,
    ema_decay=0.9995,
    quantisation_aware=True,
    perturbed_pool=640,
    reset=0.15,
    staggered_start=0.5,
    switch=0.3,
    state_shuffle=0.05,
    away=0.1,
    undisturbed_pool=128,
    undisturbed_batch=12,
    undisturbed_ticks=(200, 20_000),
    refresh_every=500,
    mine_every=500,
    stability_penalty=0.05,
    fire_rate=(0.3, 0.9),
    clocks=0.5,
    lossy=0.5,
    max_loss=0.3,
    longest_loss=3,
    stale=0.5,
    max_stale=0.7,
    stretch=10.0,
    stretched=0.28,
    damaged=0.2,
    unknown=0.27,
    ramp=(0.05, 0.2),
    failure_weighting=0.6,
    check_every=4_000,
    validation_runs=500,
)

# For any hand: what a class may become, not only the drawings of the files. docs/TRAINING.md says what it
# reaches and what it costs.
FORMS = replace(
    FULL,
    iterations=66_000,
    batch=36,
    undisturbed_pool=384,
    undisturbed_batch=14,
    stretched=0.12,
    varied=0.33,
    damaged=0.15,
    unknown=0.22,
    unlabelled=0.04,
    ramp=(0.02, 0.15),
    loss_limit=1.0,
    failure_weighting=0.3,
    refresh_every=250,
    mine_every=1000,
    trials=200,
    check_every=0,
)

RECIPES: dict[str, Recipe] = {
    "full": FULL,
    "forms": FORMS,
    # Goes on from the weights of a model by `forms`, in smaller steps, and with more that shakes a tile.
    "refine": replace(
        FORMS,
        iterations=64_000,
        learning_rate=4e-4,
        switch=0.33,
        settled=0.3,
        undisturbed_batch=13,
        stretched=0.10,
        varied=0.38,
        damaged=0.16,
        unknown=0.2,
        unlabelled=0.05,
        ramp=(0.0, 0.01),
        mine_every=800,
    ),
    # For thousands of drawings of a class, such as handwriting: what they may become is in the files.
    "many": replace(
        FULL,
        hidden=112,
        iterations=36_000,
        batch=28,
        ticks=(10, 24),
        undisturbed_pool=384,
        undisturbed_batch=8,
        mine_every=1000,
        loss_limit=1.0,
        failure_weighting=0.3,
        stretch=1.0,
        stretched=0.0,
        damaged=0.06,
        unknown=0.1,
        unlabelled=0.02,
        ramp=(0.1, 0.3),
        check_every=0,
        validation_runs=20,
    ),
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
    # Tiles also say on which side another one is missing, at the drawn size: docs/TRAINING.md says why.
    "damage": replace(
        FULL,
        iterations=30_000,
        stretch=1.0,
        stretched=0.0,
        damaged=0.45,
        unknown=0.15,
        directions=2.0,
        one_tile=0.5,
        mine_every=1000,
        trials=150,
        check_every=0,
        validation_runs=100,
    ),
    # As published: no pool, no limits, one sampler.
    "paper": Recipe(
        hidden=40,
        iterations=2_500,
        batch=128,
        ticks=(9, 29),
        learning_rate=1e-3,
        cosine=0.0,
        clip_norm=0.0,
        quantisation_aware=False,
    ),
    # Takes seconds and is of no use on tiles: it shows that the whole chain works.
    "smoke": replace(
        FULL,
        hidden=40,
        iterations=40,
        batch=8,
        ticks=(4, 8),
        perturbed_pool=32,
        undisturbed_pool=8,
        undisturbed_batch=2,
        refresh_every=15,
        mine_every=15,
        refresh_steps=(5, 20),
        trials=5,
        library=60,
        stretch=1.5,
        check_every=20,
        validation_runs=2,
    ),
}


def find_recipe(name: str) -> Recipe:
    """The recipe called `name`.

    Raises:
        UsageError: there is none; the message lists the recipes.
    """
    if name not in RECIPES:
        meant = did_you_mean(name, RECIPES)
        raise UsageError(f"no recipe '{name}'{meant}; there are: {' '.join(RECIPES)}")
    return RECIPES[name]


def aims_of(recipe: Recipe) -> Aims:
    """The aims of a recipe."""
    shown = (recipe.damaged > 0, recipe.unknown > 0, recipe.varied > 0, recipe.directions > 0)
    return Aims(recipe.stretch, *shown)


def trains_for(recipe: Recipe, key: str) -> bool:
    """Whether a recipe trains for the measurements of this key; one answer needs other drawings, too."""
    return key != "one answer" or recipe.unknown > 0 or recipe.unlabelled > 0
