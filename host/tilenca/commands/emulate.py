"""`tilenca emulate`: the firmware image on one emulated board per tile, wired as on the real board."""

import argparse
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.base.project import build_remedy, firmware_image
from tilenca.base.stdio import warn
from tilenca.commands.arguments import (
    existing_image,
)
from tilenca.commands.emulate_options import DEFAULT_UPDATES, add_emulate_arguments, check_combinations
from tilenca.commands.emulate_runs import (
    EmulationResult,
    LayOut,
    observe,
    print_results,
    run_all,
    updates_for,
)
from tilenca.commands.emulate_watch import watch_all
from tilenca.commands.origin import folder_of, model_with_id, own_drawings, own_shapes, without_a_dash
from tilenca.commands.own_firmware import image_of
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.fault_spec import FaultError
from tilenca.emulator.greeting import greeting, is_board_test, settings_of
from tilenca.emulator.lag import Lag
from tilenca.emulator.serve import STOCK_BOOTLOADER, serve
from tilenca.emulator.side_by_side import threads_of_each
from tilenca.fleet.recording import Recorder
from tilenca.model.file import Model
from tilenca.protocol.sentences import HelloSentence
from tilenca.shapes.file import UNKNOWN, Shape, Task, load_task, too_large
from tilenca.shapes.sizes import Size, size_name
from tilenca.views.emulated import foreign_firmware
from tilenca.views.lag import show_lag
from tilenca.views.progress import Tell

ALL = "all"
NO_BOOTLOADER = "none"

BOARD_TEST_IMAGE = (
    "this image is the board test, which shows no label: give --serve DIR, and read its ports "
    "(docs/BOARD_TEST.md)"
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add_emulate_arguments(parser)


@dataclass(frozen=True)
class _Run:
    """What a command line asks to emulate.

    Attributes:
        task: the shape file's.
        shapes: to emulate.
        lay_out: makes the tiles of a shape.
        told: what was said before the run about the firmware's model.
    """

    task: Task
    shapes: list[Shape]
    lay_out: LayOut
    told: list[str]


def run(args: argparse.Namespace) -> int:
    """Runs the command; 1 when a tile of any shape ends up wrong."""
    check_combinations(args)
    asked = _prepare(args)
    if args.serve is not None:
        _serve(args, asked.lay_out(asked.shapes[0]))
        return 0
    with ExitStack() as stack:
        record = stack.enter_context(Recorder(args.record, "w")) if args.record else None
        if args.watch:
            results = watch_all(args, asked.task, asked.lay_out, asked.shapes, record)
        else:
            results = run_all(args, asked.task, asked.lay_out, asked.shapes, record)
    return tell_results(args, results, asked.told)


def emulate_model(
    args: argparse.Namespace, shown: Callable[[], AbstractContextManager[Tell]]
) -> list[EmulationResult]:
    """Emulates for another command, which shows how far it is; `tell_results` prints the results.

    Args:
        args: of this command.
        shown: see `run_all`.
    """
    asked = _prepare(args)
    return run_all(args, asked.task, asked.lay_out, asked.shapes, None, shown)


def tell_results(args: argparse.Namespace, results: list[EmulationResult], told: Sequence[str] = ()) -> int:
    """Prints the results and what was noted, but for what was told before; returns the exit status.

    It is 1 where a tile is wrong, or where a state differs from the simulator's.
    """
    print_results(args, results)
    tell_notes(results, told)
    same = all(result.report.get("states", {}).get("first_difference") is None for result in results)
    return 0 if same and all(result.report["all_right"] for result in results) else 1


def tell_notes(results: list[EmulationResult], told: Sequence[str] = ()) -> None:
    """Prints what was noted of the results, but for what was told before, to stderr."""
    for note in sorted({note for result in results for note in result.notes} - set(told)):
        warn(f"tilenca: {note}")


def _prepare(args: argparse.Namespace) -> _Run:
    """The image, the shapes and the settings of the arguments."""
    image = args.elf or (image_of(args.model) if args.model else firmware_image())
    existing_image(image, f"{build_remedy()}, or give --elf")
    hello = greeting(image)
    defaults = settings_of(hello)
    known = None if hello is None else model_with_id(hello.model_id, args.model)
    if args.shapes is None:
        args.shapes = own_shapes(*known)[0] if known else paths.DEFAULT_SHAPES
    task = load_task(args.shapes)
    shapes = _chosen(task, args.shape or [ALL], args.size)
    for option in ("serve", "eeprom", "vcd", "frames", "gdb"):
        if getattr(args, option) and len(shapes) != 1:
            raise UsageError(f"--{option} needs one shape, got {len(shapes)}; give --shape NAME")
    fits = hello is None or _fits(hello, known and known[0], task)
    args.trained = None if known and fits else folder_of(task)
    if hello is None:
        told = [BOARD_TEST_IMAGE] if is_board_test(image) and not args.serve else []
    else:
        told = [] if fits else [foreign_firmware(hello, task, args.trained)]
        told += [note for note in (known and without_a_dash(known[0]),) if told and note]
    args.foreign = bool(told)
    args.own_model, args.own_folder = known or (None, None)
    own = own_drawings(*known, task) if known else {shape.name for shape in task.shapes}
    args.others = {shape.name for shape in shapes if shape.name.partition(" ")[0] not in own}
    for note in told:
        warn(f"tilenca: {note}")
    settings = EmulationSettings(
        seconds=args.seconds,
        updates=args.updates or DEFAULT_UPDATES,
        period_ms=args.period_ms,
        ppm=args.ppm,
        boot_spread_s=args.boot_spread,
        seed=args.seed,
        bootloader=_bootloader(args.bootloader),
        unpowered=args.unpowered,
        faults=tuple(args.fault),
        threads=args.threads or threads_of_each(len(shapes)),
        eeprom=args.eeprom,
    )

    def lay_out(shape: Shape) -> Emulation:
        most = None if args.updates else updates_for(shape)
        least = most if most and shape.name in args.others else settings.updates
        asked = replace(settings, updates=least, most_updates=most)
        try:
            return Emulation(shape, task.labels, image, asked, defaults)
        except FaultError as error:
            raise UsageError(f"shape '{shape.name}': {error}") from error

    return _Run(task, shapes, lay_out, told)


def _fits(hello: HelloSentence, model: Model | None, task: Task) -> bool:
    """Whether the firmware's model knows every class of the file, as far as one can tell."""
    if model is None:
        return hello.classes in (len(task.labels), len({*task.labels, UNKNOWN}))
    return set(task.labels) <= set(model.labels)


def _serve(args: argparse.Namespace, emulation: Emulation) -> None:
    """Gives the tiles' serial ports to other programs, and tells how far they fall behind."""
    lag = Lag()
    with emulation.array, observe(emulation, args) as look, show_lag(lag) as tell:

        def on_slice() -> None:
            look()
            tell()

        serve(emulation, args.serve, args.seconds, not args.keep_running, on_slice, lag)


def _bootloader(given: str | None) -> Path | None:
    if given is None:
        if not STOCK_BOOTLOADER.exists():
            warn(
                f"tilenca: no {STOCK_BOOTLOADER}, so tiles have no bootloader; install Arduino's AVR core "
                f"(Debian: arduino-core-avr), or say so with --bootloader {NO_BOOTLOADER}"
            )
            return None
        return STOCK_BOOTLOADER
    if given == NO_BOOTLOADER:
        return None
    existing_image(Path(given), f"give --bootloader an ELF or Intel HEX file, or {NO_BOOTLOADER}")
    return Path(given)


def _chosen(task: Task, names: Sequence[str], wanted: Size | None) -> list[Shape]:
    chosen = list(task.shapes) if ALL in names else [task.find(name) for name in dict.fromkeys(names)]
    if wanted is not None:
        chosen = [other for shape in chosen if (other := shape.stretched(wanted)) is not None]
        if not chosen:
            raise UsageError(
                f"--size {size_name(wanted)}: no shape can be drawn that small; try a larger one"
            )
    if (remedy := too_large(chosen)) is not None:
        raise UsageError(f"{task.path}: {remedy}")
    return chosen
