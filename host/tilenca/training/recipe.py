"""What a recipe says of a training, and what follows from it."""

from dataclasses import dataclass

from tilenca.evaluation.suites import Aims, aims_with


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


def aims_of(recipe: Recipe) -> Aims:
    """The aims of a recipe."""
    return aims_with(
        recipe.stretch,
        recipe.damaged,
        recipe.unknown,
        recipe.varied,
        recipe.unlabelled,
        directions=recipe.directions,
    )
