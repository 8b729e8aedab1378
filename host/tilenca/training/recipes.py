"""Named ways to train a model. Recipe, shapes and seed alone decide the result."""

from dataclasses import replace

from tilenca.base.errors import UsageError
from tilenca.base.suggest import did_you_mean
from tilenca.model.file import DEFAULT_HIDDEN
from tilenca.training.recipe import Recipe

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
        iterations=96_000,
        learning_rate=4e-4,
        switch=0.34,
        settled=0.4,
        undisturbed_batch=14,
        stretched=0.10,
        varied=0.36,
        damaged=0.18,
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
