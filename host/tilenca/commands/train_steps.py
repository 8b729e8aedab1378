"""A training from its plan to the files of a model; the commands that train share it."""

import argparse
import shlex
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tilenca.base.commit import commit
from tilenca.base.errors import InterruptedRunError, TilencaError, UsageError
from tilenca.base.project import place_of
from tilenca.base.stdio import warn
from tilenca.commands.train_cluster import train_on_cluster
from tilenca.commands.train_plan import TrainingPlan, usual_channels
from tilenca.evaluation.suites import Suite, make_suite
from tilenca.model.file import Model, checkpoints
from tilenca.shapes.variant import CHOOSING
from tilenca.training.recipe import aims_of
from tilenca.training.recipes import find_recipe
from tilenca.training.sessions import noted
from tilenca.training.tensorboard import event_files, move_events
from tilenca.views.training import TrainingViews

if TYPE_CHECKING:
    from tilenca.training.results import Result
    from tilenca.training.runner import Job
    from tilenca.training.trainer import Trained

SUITE_SEED = 1_000_000  # larger than any usual --seed, so that training never draws the same numbers
SELECTION_RUNS = 50  # of each drawing, to choose among seeds


@dataclass(frozen=True)
class NewModel:
    """The result of a training as it was kept.

    Attributes:
        folder: of its files, which is another one than asked for where that holds a better model.
        model: the integer model.
        metrics: as in metrics.json.
    """

    folder: Path
    model: Model
    metrics: dict[str, Any]


def train_model(
    args: argparse.Namespace,
    plan: TrainingPlan,
    views: TrainingViews,
    go_on: str,
    suite: Suite | None = None,
) -> NewModel:
    """Trains, measures, quantises, writes.

    Args:
        args: of `add_training_arguments`, with `shapes` (a list), `out` and `resume`.
        plan: of these arguments.
        views: what a person sees meanwhile.
        go_on: after an interrupt, how to go on; the end of a sentence.
        suite: `last_suite`, where it was made before.

    Raises:
        InterruptedRunError: Ctrl-C; what was trained is in checkpoints.
        TilencaError: no seed was trained to its end, or the model cannot be written.
    """
    metadata = _metadata(args)  # the commit may change while the training runs
    with noted(args.out, training_command(args, str), args.recipe, args.resume) as session:
        try:
            jobs, failed = _train(args, plan, views, session.began[-1])
        except (InterruptedRunError, KeyboardInterrupt) as error:
            raise _interrupted(args, str(error) or "while training", go_on) from None
        try:
            trained, suite = _best(jobs, args.seed), suite or last_suite(args, plan)
            result = _measured(plan, trained, suite, _suite_seed(args), metadata, args.out, views)
        except KeyboardInterrupt:
            raise _interrupted(args, "while measuring the trained model", go_on) from None

        from tilenca.training.results import keep

        where = keep(args.out, result)
        session.moved(where)
        if where != args.out:
            move_events(args.out, where, session.began)
    _draw_history(where, result)
    if failed:
        warn(f"note: {args.out}: the checkpoints of all seeds stay; --resume goes on with them")
    else:
        for path in checkpoints(args.out) if args.force else [job.checkpoint for job in jobs]:
            path.unlink()
    return NewModel(where, result.model, result.metrics)


def _train(
    args: argparse.Namespace, plan: TrainingPlan, views: TrainingViews, began: str
) -> "tuple[list[Job], bool]":
    """Trains all seeds in a session that `began` then.

    Returns:
        Their jobs, whose checkpoints hold results, and whether any failed.
    """
    from tilenca.training.runner import train_side_by_side

    jobs = jobs_of(args, plan)
    with ExitStack() as stack:
        tell = stack.enter_context(views.training(plan.seeds, plan.recipe.iterations))
        if args.tensorboard:
            tell = stack.enter_context(event_files(args.out, began, tell))
        if args.scheduler is None:
            failures = train_side_by_side(jobs, at_once(args, plan), tell)
        else:
            failures = train_on_cluster(jobs, args.scheduler, tell)
    for failure in failures:
        warn(failure)
    return jobs, bool(failures)


def at_once(args: argparse.Namespace, plan: TrainingPlan) -> int:
    """How many seeds train at a time."""
    from tilenca.base.processors import processors

    return min(args.jobs or processors(), len(plan.seeds))


def jobs_of(args: argparse.Namespace, plan: TrainingPlan) -> "list[Job]":
    """The seeds' trainings."""
    from tilenca.base.processors import processors
    from tilenca.training.config import Config
    from tilenca.training.runner import Job

    threads = max(1, processors() // at_once(args, plan)) if args.scheduler is None else 1
    configs = [
        Config(plan.recipe, plan.dimensions, n, plan.task.labels, plan.task.sources, plan.initial)
        for n in plan.seeds
    ]
    return [
        Job(config, plan.task, plan.sizes, args.device, args.out, args.resume, threads) for config in configs
    ]


def check_resumed(args: argparse.Namespace, plan: TrainingPlan) -> None:
    """Refuses at once to go on from checkpoints of another run.

    Raises:
        UsageError: what differs, or a checkpoint is damaged.
    """
    from tilenca.training.checkpoint import glance, refuse_other

    for job in jobs_of(args, plan) if args.resume else []:
        if job.checkpoint.exists():
            refuse_other(job.checkpoint, glance(job.checkpoint)["config"], job.config.as_json())


def _metadata(args: argparse.Namespace) -> dict[str, object]:
    """The model's origin, as far as its configuration does not tell it."""
    return {
        "command": training_command(args),
        "shapes": [place_of(path) for path in args.shapes],
        "commit": commit(),
        "recipe_name": args.recipe,
    }


def last_suite(args: argparse.Namespace, plan: TrainingPlan) -> Suite:
    """What the finished model is asked; making it takes seconds.

    Its drawings and runs are other ones than those that decide when to stop, and which seed is best.
    """
    labels = plan.task.labels
    return make_suite(plan.task, plan.sizes, labels, aims_of(plan.recipe), _suite_seed(args))


def _suite_seed(args: argparse.Namespace) -> int:
    return SUITE_SEED + int(args.seed)


def _measured(
    plan: TrainingPlan,
    trained: "Trained",
    suite: Suite,
    seed: int,
    metadata: dict[str, object],
    out: Path,
    views: TrainingViews,
) -> "Result":
    """The integer model of a training, and its metrics.

    Args:
        plan: of the training.
        trained: the best seed.
        suite: what the model is asked.
        seed: of the runs.
        metadata: of the model.
        out: the model's folder.
        views: what a person sees meanwhile.
    """
    from tilenca.evaluation.validation import validate
    from tilenca.evaluation.workload import work_of
    from tilenca.simulator.engine import FastEngine
    from tilenca.training.results import Result
    from tilenca.training.trainer import model_of

    model, cut = model_of(trained, {**metadata, **trained.config.as_json()})
    engine = FastEngine(model)
    with views.measuring(str(out / "README.md"), work_of(engine, suite, plan.validation_runs).rows) as tell:
        metrics = validate(engine, suite, plan.validation_runs, seed, tell)
    metrics |= {"weights_cut": cut, "iterations": trained.iteration, "ended_early": trained.ended}
    metrics["best_iteration"] = trained.best_iteration
    return Result(model, metrics, trained.history, trained.checks)


def _draw_history(where: Path, result: "Result") -> None:
    from tilenca.training.results import history_table
    from tilenca.views.abilities import targets_by_kind
    from tilenca.views.training_plot import plot_history

    if result.history:
        columns, rows = history_table(result)
        title = f"Training of model {result.model.model_id:04X}"
        plot_history(rows, where / "history.png", columns, title, targets_by_kind(result.metrics))


def _best(jobs: "list[Job]", suite_seed: int) -> "Trained":
    """The finished run with the least shortfall."""
    from tilenca.evaluation.evaluator import Evaluator
    from tilenca.simulator.engine import FastEngine
    from tilenca.training.trainer import model_of, trained_at

    finished = []
    for job in jobs:
        with suppress(UsageError):  # a failure of this run has been reported already
            finished.append(trained_at(job.checkpoint, job.config))
    finished = [trained for trained in finished if trained.done]
    if not finished:
        raise TilencaError("no seed was trained to its end; see above, or try another --seed")
    if len(finished) == 1:
        return finished[0]
    shortfalls = []
    for trained in finished:
        model, _ = model_of(trained, {})
        suite = make_suite(
            jobs[0].task, jobs[0].sizes, model.labels, aims_of(trained.config.recipe), suite_seed, CHOOSING
        )
        rows = Evaluator(FastEngine(model), suite, SELECTION_RUNS, suite_seed).short_rows()
        shortfalls.append(sum(row.shortfall for row in rows))
        warn(f"seed {trained.config.seed}: short of its targets by {shortfalls[-1]:.4f} in all")
    return finished[shortfalls.index(min(shortfalls))]


def _interrupted(args: argparse.Namespace, where: str, go_on: str) -> InterruptedRunError:
    if not checkpoints(args.out):
        return InterruptedRunError(
            f"interrupted {where}, before the first iteration was done: there is nothing to go on from yet; "
            "run the same command again"
        )
    return InterruptedRunError(f"interrupted {where}; {go_on}")


def training_command(args: argparse.Namespace, place: Callable[[Path], str] = place_of) -> str:
    """The command that makes this model."""
    recipe = find_recipe(args.recipe)
    words = ["tilenca", "train", "--shapes", *map(place, args.shapes), "--out", place(args.out)]
    words += ["--recipe", args.recipe, "--seed", str(args.seed)]
    words += ["--seeds", str(args.seeds or recipe.seeds)]
    words += ["--iterations", str(args.iterations or recipe.iterations)]
    if args.weights is None:
        hidden, usual = args.hidden or recipe.hidden, usual_channels(recipe)
    else:
        words += ["--weights", place(args.weights)]
        hidden, usual = args.hidden, None
    if hidden is not None:
        words += ["--hidden", str(hidden)]
    for option, default in (
        ("learning_rate", None),
        ("state", usual),
        ("device", "cpu"),
        ("validation_runs", None),
    ):
        if (value := getattr(args, option)) not in (None, default):
            words += [f"--{option.replace('_', '-')}", str(value)]
    return shlex.join(words)
