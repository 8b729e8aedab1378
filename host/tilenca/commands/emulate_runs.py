"""The runs of `tilenca emulate` after the shapes are laid out: run them, watch them, report."""

import argparse
import json
import math
import shlex
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rich.console import Console

from tilenca.base.project import place_of
from tilenca.base.stdio import warn
from tilenca.commands.emulate_states import StateCheck
from tilenca.commands.origin import knows_no_damage, why_wrong
from tilenca.emulator.debug import attend, debuggers, frames, waveforms
from tilenca.emulator.eeprom_files import save_eeprom
from tilenca.emulator.experiment import SLICE_S, Emulation
from tilenca.emulator.side_by_side import run_side_by_side
from tilenca.emulator.types import port_name
from tilenca.evaluation.cases import steps_for
from tilenca.fleet.grid import Laid
from tilenca.fleet.recording import Recorder, as_record
from tilenca.protocol.line_reader import Heard
from tilenca.shapes.file import Shape, Task
from tilenca.views.emulated import WRONG, judge, mismatch, take_picture, verdict
from tilenca.views.progress import Tell, show_progress
from tilenca.views.tiles import Picture, beside

PLAIN_WIDTH = 80
MOST_NAMED = 8  # drawings in a note
LONG_SLICE_S = 0.5  # where nobody looks sooner: fewer calls for the same lines
AFTERWARDS_S = 2  # that the tiles of an example have after a fault

# Lays out one shape in tiles.
LayOut = Callable[[Shape], Emulation]


@dataclass(frozen=True)
class EmulationResult:
    """A shape that has run to its end; `notes` are for stderr, once each."""

    report: dict[str, Any]
    picture: Picture
    verdict: str
    notes: tuple[str, ...]


def keep(record: Recorder | None, shape: Shape, heard: Sequence[Heard]) -> None:
    """Writes what the tiles of a shape said into a recording, and before it where they lie."""
    if record is None or not heard:
        return
    laid = {port_name(number): Laid(cell, number + 1) for number, cell in enumerate(shape.cells)}
    record.place(heard[0].time_s, laid, shape=shape.name)
    lines = [{**as_record(line), "tile": laid[line.port].tile, "shape": shape.name} for line in heard]
    record.write(json.dumps(line) + "\n" for line in lines)


def result_of(args: argparse.Namespace, emulation: Emulation, task: Task, started: float) -> EmulationResult:
    """The result of a shape that has run to its end.

    Args:
        args: the command line.
        emulation: that has ended.
        task: that the shape is of.
        started: when, on the monotonic clock.
    """
    notes = [f"not emulated: {warning}" for tile in emulation.array for warning in tile.warnings]
    notes += _too_late(emulation)
    expected = 0 if args.foreign else updates_for(emulation.shape)
    if args.own_model is None and (remedy := mismatch(emulation, task, args.trained)):
        notes.append(remedy)
        expected = 0  # more time would not help
    judged = judge(emulation, expected)
    if judged == WRONG and args.own_model is not None and not (args.foreign or args.fault):
        notes.append(why_wrong(args.own_model, task, args.size))
    if judged == WRONG and args.own_model is not None and not all(tile.powered for tile in emulation.array):
        notes += filter(None, [knows_no_damage(args.own_model)])
    if args.others and args.own_model is not None and not args.foreign:
        notes.append(_of_one_run(args, task))
    report = emulation.report(time.monotonic() - started) | {"verdict": judged}
    words = verdict(emulation, expected, args.verbose, args.own_folder and place_of(args.own_folder))
    return EmulationResult(report, take_picture(emulation), words, tuple(notes))


def _of_one_run(args: argparse.Namespace, task: Task) -> str:
    """What a right answer on a drawing that the model was not made of says, and how to ask more."""
    drawings = sorted(name.partition(" ")[0] for name in args.others)
    named = shlex.join(word for name in drawings for word in ("--shape", name)) if len(drawings) == 1 else ""
    words = [f"tilenca simulate --model {shlex.quote(str(args.own_folder))}"]
    words += [f"--shapes {shlex.quote(str(task.path))}", *([named] if named else []), "--runs 100"]
    which = " ".join(drawings[:MOST_NAMED]) + (" ..." if len(drawings) > MOST_NAMED else "")
    return f"note: the model was not made of {which}: this is one run of one seed; more: {' '.join(words)}"


def _too_late(emulation: Emulation) -> Iterator[str]:
    """A note for each fault that was to begin after the end of the run."""
    for fault in emulation.settings.faults:
        if fault.from_s >= emulation.array.time_s:
            seconds = math.ceil(fault.from_s) + AFTERWARDS_S
            yield (
                f"note: --fault '{fault.text}' had not begun when shape '{emulation.shape.name}' ended after "
                f"{emulation.array.time_s:.1f} s; run on, with --seconds {seconds}"
            )


def updates_for(shape: Shape) -> int:
    """The updates in which the tiles of a drawing may agree: as many as its model is measured with."""
    return steps_for((len(shape.rows), len(shape.rows[0])))


@contextmanager
def observe(
    emulation: Emulation, args: argparse.Namespace, stopped: Callable[[], bool] = lambda: False
) -> Iterator[Callable[[], None]]:
    """Opens the outputs of the options; the caller calls the yielded function after every slice of time.

    Args:
        emulation: the tiles.
        args: the command line.
        stopped: whether the run was interrupted; a thread other than the main one sees no Ctrl-C.
    """
    with (
        _kept_eeprom(emulation, args.eeprom),
        waveforms(emulation, args.vcd, args.pin) as waves,
        frames(emulation, args.frames) as log,
        debuggers(emulation, args.gdb, stopped) as ports,
    ):

        def on_slice() -> None:
            if waves is not None:
                waves.collect()
            if log is not None:
                log.collect()
            attend(ports, stopped)

        on_slice()
        yield on_slice


@contextmanager
def _kept_eeprom(emulation: Emulation, directory: Path | None) -> Iterator[None]:
    try:
        yield
    finally:
        if directory is not None:
            for tile in emulation.array:
                save_eeprom(tile, directory)


def run_all(
    args: argparse.Namespace,
    task: Task,
    lay_out: LayOut,
    shapes: Sequence[Shape],
    record: Recorder | None,
    shown: Callable[[], AbstractContextManager[Tell]] | None = None,
) -> list[EmulationResult]:
    """Runs shapes side by side, as fast as they go; results come in the order of the shapes.

    Args:
        args: the command line.
        task: that the shapes are of.
        lay_out: makes the tiles of a shape.
        shapes: to run.
        record: gets what the tiles say.
        shown: shows how far the shapes are; None: bars, and a line about each shape.
    """
    results = []
    with (shown or show_progress)() as tell:

        def run(shape: Shape, stopped: threading.Event) -> tuple[EmulationResult, list[Heard]]:
            return _run_one(args, task, lay_out, shape, tell, stopped)

        for shape, (result, heard) in run_side_by_side(run, shapes):
            results.append(result)
            emulated_s, wall_s = result.report["simulated_s"], result.report["wall_s"]
            speed = emulated_s / max(wall_s, 0.001)
            if shown is None:
                warn(f"{shape.name}: {emulated_s:.1f} s emulated, {speed:.1f} times real time")
            keep(record, shape, heard)
    return results


def _run_one(
    args: argparse.Namespace, task: Task, lay_out: LayOut, shape: Shape, tell: Tell, stopped: threading.Event
) -> tuple[EmulationResult, list[Heard]]:
    """Runs one shape to its end; returns the result and the lines to record."""
    started = time.monotonic()
    kept: list[Heard] = []
    tell(shape.name, 0.0, "laying out")
    emulation = lay_out(shape)
    with emulation.array, observe(emulation, args, stopped.is_set) as on_slice:
        check = StateCheck(emulation, args.own_model) if args.check_states else None

        def look(running: Emulation, heard: list[Heard]) -> None:
            tell(shape.name, running.share_done(), f"{running.array.time_s:.2f} s emulated")
            if stopped.is_set():
                raise KeyboardInterrupt
            on_slice()
            if check is not None:
                check.look()
            if args.record is not None:
                kept.extend(heard)

        looked_at = any((args.fault, args.vcd, args.frames, args.gdb, args.check_states))
        emulation.run(look, SLICE_S if args.seconds is None or looked_at else LONG_SLICE_S)
        result = result_of(args, emulation, task, started)
        if check is not None:
            words = f"{result.verdict}; {check.words()}"
            result = replace(result, report=result.report | {"states": check.report()}, verdict=words)
        return result, kept


def print_results(args: argparse.Namespace, results: Sequence[EmulationResult]) -> None:
    """Prints pictures, verdicts and a summary, or the JSON document."""
    all_right = all(result.report["all_right"] for result in results)
    if args.json:
        reports = [result.report for result in results]
        print(json.dumps(reports[0] if len(reports) == 1 else {"runs": reports, "all_right": all_right}))
        return
    console = Console(highlight=False)
    if not (args.watch and console.is_terminal):  # there the last picture still stands
        width = console.width if console.is_terminal else PLAIN_WIDTH
        console.print(beside([result.picture for result in results], console, width), soft_wrap=True)
    for result in results:
        console.print(result.verdict, soft_wrap=True, markup=False)
    right = sum(result.report["all_right"] for result in results)
    emulated_s = sum(result.report["simulated_s"] for result in results)
    tiles = sum(len(result.report["tiles"]) for result in results)
    console.print(
        f"{right} of {len(results)} shapes right; {tiles} tiles, {emulated_s:.1f} s emulated", soft_wrap=True
    )
