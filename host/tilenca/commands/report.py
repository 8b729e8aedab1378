"""`tilenca report`: every claim, measured again, with the command of each number."""

import argparse
import json
import platform
import shlex
import time
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from tilenca import __version__
from tilenca.base import paths
from tilenca.base.errors import BuildError, InterruptedRunError
from tilenca.base.processors import processors
from tilenca.base.project import build_remedy, firmware_image
from tilenca.base.stdio import warn
from tilenca.base.whole_file import write_whole
from tilenca.commands.arguments import add_cluster_arguments, existing_image
from tilenca.emulator.greeting import greeting
from tilenca.model.file import Model, load_model
from tilenca.views.progress import show_progress

if TYPE_CHECKING:
    from tilenca.report.document import Facts
    from tilenca.report.experiment import Experiment
    from tilenca.report.measure import Call, Folder, Results

REMEDY = "make room there, or give another --out"
MINUTES = {False: "some fifteen minutes of two cores", True: "some two minutes of two cores"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    add = parser.add_argument
    add(
        "--quick",
        action="store_true",
        help=f"few runs and fewer rows: {MINUTES[True]} (the full one: {MINUTES[False]})",
    )
    add(
        "--out",
        type=Path,
        required=True,
        metavar="DIR",
        help="where the report goes, and what is measured so far",
    )
    add_cluster_arguments(parser)
    add("--json", action="store_true", help="print the rows as one JSON document")


def run(args: argparse.Namespace) -> int:
    """Measures what the folder lacks, and writes page, Markdown, figures and JSON."""
    from tilenca.report.document import Gap, apart_of, figures_of, gap_of, render, sections_of
    from tilenca.report.experiments import chosen
    from tilenca.report.measure import Folder, calls_of, rows_of
    from tilenca.views.report import draw_figure

    model, image = load_model(paths.DEFAULT_MODEL), firmware_image()
    existing_image(image, build_remedy())
    _check_firmware(image, model)
    experiments, images = _measurable(chosen(args.quick))
    measured = [
        *paths.MODELS.glob("*/weights.npz"),
        *paths.DEFAULT_SHAPES.parent.glob("*.toml"),
        image,
        *images,
    ]
    folder = Folder(args.out / "results", measured)
    results = _measure(args, calls_of(experiments, args.quick), folder)
    rows = rows_of(experiments, args.quick, results)
    figures = [
        figure if figure.maps else replace(figure, svg=draw_figure(figure))
        for figure in figures_of(experiments, rows)
    ]
    sections = sections_of(experiments, rows, figures)
    gap = Gap(gap_of(rows), apart_of(rows))
    facts = _facts(args, f"{model.model_id:04X}")
    every = [row.as_json() for mine in rows.values() for row in mine]
    files = {"report.json": json.dumps({"rows": every}, indent=1)}
    for name, template in (("report.html", "page.html.j2"), ("RESULTS.md", "results.md.j2")):
        files[name] = render(template, facts, sections, gap)
    for section in sections:
        for number, figure in enumerate(section["figures"], 1):
            if figure.maps:
                continue
            files[f"images/results-{section['key']}-{number}.svg"] = figure.svg + "\n"
    (args.out / "images").mkdir(exist_ok=True)
    for name, text in files.items():
        write_whole(args.out / name, text.encode(), REMEDY)
    if args.json:
        print(json.dumps({"rows": every, "files": [str(args.out / name) for name in files]}))
    else:
        print(f"{len(every)} rows; open {args.out / 'report.html'}")
    return 0


def _measurable(experiments: "list[Experiment]") -> "tuple[list[Experiment], list[Path]]":
    """The experiments whose firmware is built, and the images beside models; says which are left out."""
    kept, images = [], []
    for experiment in experiments:
        folder = experiment.emulated_model(paths.MODELS)
        if folder not in (None, paths.DEFAULT_MODEL):
            beside = paths.model_elf(folder)
            if not beside.exists():
                warn(
                    f"left out: {experiment.key}, since no firmware of models/{folder.name} is built; "
                    f"run: tilenca export --model {folder.name} --build"
                )
                continue
            images.append(beside)
        kept.append(experiment)
    return kept, images


def _check_firmware(image: Path, model: Model) -> None:
    """The report says what the shipped digits do, and its emulated tiles must be of them."""
    hello = greeting(image)
    if hello is None or hello.model_id != model.model_id:
        raise BuildError(
            f"{image}: not the firmware of {paths.DEFAULT_MODEL.name}; run: tilenca export --model "
            f"{paths.DEFAULT_MODEL.name} && pio run"
        )


def _measure(args: argparse.Namespace, calls: "list[Call]", folder: "Folder") -> "Results":
    from tilenca.cluster.client import open_cluster
    from tilenca.report.measure import measure

    started, results = time.monotonic(), folder.results(calls)
    missing = [call for call in calls if call.key not in results]
    if not missing:
        return results
    had = len(results)
    with show_progress() as tell:

        def told(more: int) -> None:
            tell("report", (had + more) / len(calls), f"{had + more} of {len(calls)} experiments")

        told(0)
        warn(
            f"{len(missing)} of {len(calls)} experiments to measure: {MINUTES[args.quick]}; "
            "Ctrl-C keeps what is done"
        )
        try:
            with open_cluster(args.scheduler, args.jobs or processors()) as cluster:
                warn(f"{cluster.workers()} workers{cluster.dashboard()}")
                results |= measure(missing, folder, cluster, told)
        except KeyboardInterrupt:
            raise InterruptedRunError(
                f"interrupted; {args.out} has what is measured so far; to go on, run the same command again"
            ) from None
    warn(f"measured in {time.monotonic() - started:.0f} s")
    return results


def _facts(args: argparse.Namespace, model: str) -> "Facts":
    from tilenca.report.document import Facts

    words = ["tilenca", "report", *(["--quick"] if args.quick else []), "--out", str(args.out)]
    machine = f"{processors()} processors ({platform.machine()})"
    return Facts(
        shlex.join(words), __version__, model, datetime.now(UTC).date().isoformat(), machine, args.quick
    )
