"""`tilenca train` from drawings to a model on disk: same seed, same bytes, interrupted or not; refusals."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from support.training import DAMAGE, SMOKE, job_of, trainer
from tilenca.base import paths
from tilenca.base.errors import TilencaError, UsageError
from tilenca.evaluation.metrics import TARGETS, Target
from tilenca.training.runner import HOLDS_TO_END, make_trainer
from tilenca.training.runner import train as train_one
from tilenca.training.trainer import model_of, trained_at


def test_another_seed_gives_another_model() -> None:
    one, two = trainer(seed=1), trainer(seed=2)
    for learner in (one, two):
        learner.step()
    assert not np.array_equal(one.net.arrays()["w3"], two.net.arrays()["w3"])


def test_a_training_that_begins_with_weights_of_a_model_goes_on_from_them(tmp_path: Path) -> None:
    first = trainer()
    first.step()
    model, _ = model_of(first.now(), {})
    job = job_of([paths.DEFAULT_SHAPES], tmp_path)
    job = replace(job, config=replace(job.config, initial=model))
    second = make_trainer(job)
    for name, weights in second.net.arrays().items():
        assert np.array_equal(weights, model.floats[name])
    second.save(job.checkpoint)
    with pytest.raises(UsageError, match="--weights None, the checkpoint has"):
        trained_at(job.checkpoint, replace(job.config, initial=None))


def test_training_ends_early_once_all_targets_held_several_times(
    two_shapes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tilenca.evaluation.metrics.TARGETS", dict.fromkeys(TARGETS, Target(0.0)))
    recipe = replace(SMOKE, iterations=400, check_every=10)
    trainer = train_one(job_of([two_shapes], tmp_path, recipe=recipe), lambda _: None)
    assert trainer.ended
    assert trainer.iteration == 10 * HOLDS_TO_END


@pytest.mark.parametrize(
    ("unknown", "ends"), [(0.0, True), (0.2, False)], ids=["not trained for", "trained for"]
)
def test_a_target_that_the_recipe_does_not_train_for_keeps_no_training_going(
    unknown: float, ends: bool, two_shapes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    easy = dict.fromkeys(TARGETS, Target(0.0)) | dict.fromkeys(
        ("one answer", "one tile too many"), Target(2.0)
    )
    monkeypatch.setattr("tilenca.evaluation.metrics.TARGETS", easy)
    recipe = replace(SMOKE, iterations=80, check_every=10, unknown=unknown, damaged=0.0)
    trained = train_one(job_of([two_shapes], tmp_path, recipe=recipe), lambda _: None)
    assert trained.ended == ends
    assert "one answer" in trained.checks[-1][2], "it is measured all the same"


def test_what_was_measured_best_is_kept(tmp_path: Path) -> None:
    job = job_of([paths.DEFAULT_SHAPES], tmp_path)
    learner = make_trainer(job)
    for shortfall in (0.5, 0.25, 0.75):
        learner.step()
        learner.measured(shortfall, {})
        if shortfall == 0.25:
            wanted = learner.now().weights
    learner.save(job.checkpoint)
    for trained in (learner.best(), trained_at(job.checkpoint, job.config)):
        assert trained.best_iteration == 2
        for name, weights in trained.weights.items():
            assert np.array_equal(weights, wanted[name])
    assert not np.array_equal(learner.now().weights["w3"], wanted["w3"])


def test_two_drawings_are_told_apart_after_a_short_training(two_shapes: Path) -> None:
    recipe = replace(
        SMOKE, iterations=200, ticks=(8, 12), learning_rate=5e-3, perturbed_pool=0, undisturbed_pool=0
    )
    recipe = replace(recipe, undisturbed_batch=0, refresh_every=0, clocks=0.0)
    recipe = replace(recipe, lossy=0.0, damaged=0.0, unknown=0.0, varied=0.0, unlabelled=0.0)
    learner = make_trainer(job_of([two_shapes], paths.BUILD, 1, 16, recipe))
    agreements = [learner.step().agreement for _ in range(200)]
    assert np.mean(agreements[:20]) < 0.6
    assert np.mean(agreements[-50:]) > 0.8


def test_loss_that_is_not_a_number_stops_training() -> None:
    learner = trainer()
    with torch.no_grad():
        next(learner.net.parameters())[0, 0] = torch.nan
    with pytest.raises(TilencaError, match=r"loss is nan at iteration 1.*--seed"):
        learner.step()


@pytest.mark.skipif(not torch.cuda.is_available(), reason="PyTorch finds no CUDA device here")
def test_a_gpu_trains_the_same_but_for_rounding(tmp_path: Path) -> None:
    job = job_of([paths.DEFAULT_SHAPES], tmp_path)
    learners = [make_trainer(replace(job, device=device)) for device in ("cpu", "cuda")]
    for _ in range(3):
        losses = [learner.step().loss for learner in learners]
        assert losses[1] == pytest.approx(losses[0], rel=1e-3)


def test_the_error_of_the_directions_trains_their_channels() -> None:
    """They begin at zero, which is right for most tiles: what moves them are the tiles beside gaps."""
    learner = trainer(recipe=replace(DAMAGE, batch=16, perturbed_pool=48))
    learner.step()
    bias = learner.net.arrays()["b3"]
    first = len(bias) - len(learner.config.labels) - 4
    assert (bias[first : first + 4] > 0).any()
    model, _ = model_of(learner.now(), {})
    assert model.dimensions.directions == 4


def test_directions_are_right_only_if_all_tiles_of_a_grid_say_them() -> None:
    learner = trainer(recipe=DAMAGE)
    taken = learner.pools.take(0.5)
    gaps = learner._gaps(taken)
    assert gaps is not None
    assert gaps.missing.shape == (len(taken.batch.sample), 4)
    drawn = learner.pools.drawings.shapes[taken.drawing[0]]
    assert len(drawn.cells) == (taken.batch.sample == 0).sum(), "drawings are those of the grids"
    assert trainer()._gaps(taken) is None
