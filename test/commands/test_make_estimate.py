"""How long the steps of `tilenca make` will take."""

from argparse import Namespace
from pathlib import Path

import pytest

from support.making import asked
from tilenca.base import paths
from tilenca.commands import make_estimate
from tilenca.commands.make_estimate import Pace, building_s, emulating_s, measuring_s, pace_of, training_s
from tilenca.commands.train_plan import make_plan
from tilenca.commands.train_steps import jobs_of, last_suite
from tilenca.model.file import checkpoints, load_model
from tilenca.training.runner import make_trainer, train
from tilenca.training.trainer import model_of


def test_the_estimate_counts_what_is_left_of_every_seed(two_shapes: Path, tmp_path: Path) -> None:
    args = asked(two_shapes, tmp_path, "--seeds", "2", "--jobs", "1")
    first, second = jobs_of(args, make_plan(args))
    trainer = make_trainer(first)
    for _ in range(30):
        trainer.step()
    trainer.save(first.checkpoint)
    args.resume = True
    first, second = jobs_of(args, make_plan(args))
    assert [make_estimate._left(job) for job in (first, second)] == [10, 40]
    trainer.ended = True
    trainer.iteration = 35
    trainer.save(first.checkpoint)
    assert make_estimate._left(first) == 0, "it ended before its last iteration"
    trainer.iteration = 40
    trainer.save(first.checkpoint)
    seconds, model = training_s(args, make_plan(args))
    assert seconds > 0.0, "the second one has all to do"
    assert model.dimensions == make_plan(args).dimensions
    assert make_estimate._longest([10, 40, 20, 5], 1) == 75
    assert make_estimate._longest([10, 40, 20, 5], 2) == 40
    assert make_estimate._longest([10, 40], 4) == 40


def test_the_iterations_that_were_timed_are_kept_and_lead_to_the_same_model(
    two_shapes: Path, trained_model: Path, tmp_path: Path
) -> None:
    args = asked(two_shapes, tmp_path, "--force")
    training_s(args, make_plan(args))
    assert not checkpoints(tmp_path), "--force begins anew"
    args = asked(two_shapes, tmp_path)
    training_s(args, make_plan(args))
    (job,) = jobs_of(args, make_plan(args))
    assert args.resume
    assert 3 < make_trainer(job).iteration < 20, "a measurement at 20 iterations is the training's own"
    trained = train(job, lambda news: None)
    model, _ = model_of(trained, {})
    assert model.model_id == load_model(trained_model).model_id


def test_measuring_takes_longer_the_more_runs_and_the_slower_the_machine(
    two_shapes: Path, tmp_path: Path
) -> None:
    args = asked(two_shapes, tmp_path)
    plan = make_plan(args)
    suite, (_, model) = last_suite(args, plan), training_s(args, plan)
    few, many = (measuring_s(model, suite, runs, Pace(1e-6, 1.0)) for runs in (10, 100))
    assert few < many < 10.5 * few
    assert measuring_s(model, suite, 10, Pace(2e-6, 2.0)) == pytest.approx(2 * few)
    pace = pace_of(model, plan.task)
    assert pace.update_s > 0.0
    assert pace.factor > 0.0


def test_emulating_takes_longer_the_more_tiles_and_the_slower_the_machine(
    two_shapes: Path, tmp_path: Path, firmware: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    args = asked(two_shapes, tmp_path)
    plan, more = make_plan(args), make_plan(asked(paths.DEFAULT_SHAPES, tmp_path))
    monkeypatch.setattr(paths, "firmware_elf", lambda: tmp_path / "none")
    guessed = emulating_s(args, plan, Pace(1e-6, 1.0))
    assert guessed < emulating_s(args, more, Pace(1e-6, 1.0))
    assert emulating_s(args, plan, Pace(1e-6, 3.0)) == pytest.approx(3 * guessed)
    monkeypatch.setattr(paths, "firmware_elf", lambda: firmware)
    assert (make_estimate._tile_second_s(args) or 0.0) > 0.0
    monkeypatch.setattr(make_estimate, "side_by_side", lambda runs: 1)
    monkeypatch.setattr(make_estimate, "_tile_second_s", lambda args: 7.0)
    of_all_tiles = make_estimate.EMULATED_S * int(plan.task.sizes.sum()) * 7.0
    assert emulating_s(args, plan, Pace(1e-6, 1.0)) == pytest.approx(make_estimate.EMULATE_S + of_all_tiles)


def test_a_firmware_that_was_built_in_the_folder_before_is_built_sooner(tmp_path: Path) -> None:
    args = Namespace(out=tmp_path)
    cold = building_s(args, Pace(1e-6, 1.0))
    image = paths.model_elf(tmp_path)
    image.parent.mkdir(parents=True)
    image.touch()
    assert building_s(args, Pace(1e-6, 1.0)) < cold
    assert building_s(args, Pace(1e-6, 4.0)) == 4 * building_s(args, Pace(1e-6, 1.0))
