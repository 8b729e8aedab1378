"""The native emulator behind the page: one run at a time, in any speed, with hands in it."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from math import floor
from pathlib import Path

from tilenca.base.errors import TilencaError, UsageError
from tilenca.emulator.arrangement import Arrangement, BoardMoment, Place
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.fault_spec import parse as parse_fault
from tilenca.emulator.history import QUANTUM_S
from tilenca.page.by_hand import do_by_hand, tile_of
from tilenca.page.offer import Drawing
from tilenca.page.pace import Pace
from tilenca.page.stepper import Stepper
from tilenca.page.teller import VOICE_BYTES, Said, Teller
from tilenca.page.timeline import Timeline
from tilenca.protocol import stream_commands as commands
from tilenca.protocol import stream_hands as hands
from tilenca.protocol.settings import Settings
from tilenca.protocol.stream import (
    StreamEvent,
    deed_event,
    jump_event,
    pace_event,
    refused_event,
    run_event,
    stream_event,
)
from tilenca.protocol.stream_fields import MAX_PLACE, MOST_TILES
from tilenca.shapes.edits import rows_of
from tilenca.shapes.file import UNKNOWN, Shape
from tilenca.shapes.glyphs import looks_of

# Up to this speed there is time to look at single frames on the cables.
FRAMES_SPEED = 0.3
# An instruction after which a tile sleeps ends with its waking, which no planned fault may overtake.
LONGEST_STEP_S = 0.1


@dataclass(frozen=True)
class _Moment:
    """A board, and what its tiles have said until then."""

    board: BoardMoment
    said: Said


class EmulatedSource:
    """Runs drawings on emulated tiles, as commands ask for."""

    def __init__(
        self, image: Path, defaults: Settings | None, labels: Sequence[str], drawings: Sequence[Drawing]
    ) -> None:
        """Runs nothing until the first `Open`.

        Args:
            image: the firmware.
            defaults: the result of `firmware_settings`.
            labels: of the image's classes, in their order.
            drawings: to offer.
        """
        self._image, self._defaults = image, defaults
        self._labels, self._drawings = tuple(labels), tuple(drawings)
        self._emulation: Emulation | None = None
        self._pace = Pace(1.0, paused=True)
        self._resting = False
        self._events: list[StreamEvent] = []

    def begin(self) -> list[StreamEvent]:
        """What is here: labels with their looks, drawings, limits."""
        looks = looks_of([*self._labels, UNKNOWN] if UNKNOWN not in self._labels else self._labels)
        return [
            stream_event(
                "emulated",
                looks=[
                    {"label": look.label, "segments": look.segments, "rgb": list(look.colour)}
                    for look in looks
                ],
                drawings=[
                    {"name": one.name, "label": one.shape.label, "rows": list(one.shape.rows)}
                    for one in self._drawings
                ],
                period_ms=self._defaults.period_ms if self._defaults else None,
                most_tiles=MOST_TILES,
                most_place=MAX_PLACE,
            )
        ]

    # --- commands ---

    def take(self, command: commands.StreamCommand) -> None:
        """Carries out a command; see `tilenca.page.session.Source`."""
        match command:
            case commands.Open():
                self._open(command)
            case commands.Rest(on):
                self._resting = on
            case commands.Pace(speed, paused):
                self._pace.set(speed, paused)
                self._tell_pace()
            case commands.Step(seconds):
                if self._pace.paused and self._emulation is not None:
                    self._run(seconds)
                    self._pace.set(self._pace.speed, paused=True)
            case commands.Seek(seconds, forget):
                self._seek(seconds, forget)
            case commands.Instruct(port, count):
                self._instruct(port, count)
            case commands.Seen():
                raise UsageError("seen: the server takes it itself")
            case _:
                self._lay_hands_on(command)
        if self._emulation is not None:
            self._events += self._teller.places()

    def _lay_hands_on(self, command: hands.Hand) -> None:
        if self._emulation is None:
            raise UsageError("nothing runs yet; open a drawing first")
        self._release()
        do_by_hand(self._board, command)
        self._timeline.note(self._array.time_s, command)
        self._keep()
        self._tell_pace()  # another future begins
        self._events.append(deed_event(self._array.time_s, commands.told(command)))

    def _do_planned(self, planned: commands.Deed) -> None:
        """What a hand does at its time; what cannot be done is told, and forgotten."""
        try:
            do_by_hand(self._board, planned[1])
        except UsageError as error:
            self._timeline.forget(planned)
            self._events.append(refused_event(0.0, str(error)))

    def _open(self, wanted: commands.Open) -> None:
        deeds = [(floor(time_s / QUANTUM_S + 0.5) * QUANTUM_S, deed) for time_s, deed in wanted.deeds]
        faults = tuple(parse_fault(text) for text in wanted.faults)
        cells = sorted(wanted.cells)
        settings = EmulationSettings(boot_spread_s=wanted.spread_s, seed=wanted.seed, faults=faults)
        shape = self._shape(cells)
        emulation = Emulation(shape, self._labels, self._image, settings, self._defaults)
        self.close()
        self._emulation = emulation
        self._array = emulation.array
        self._board = Arrangement(emulation, cells)
        self._teller = Teller(self._array, self._board)
        self._stepper = Stepper(self._array)
        self._timeline: Timeline[_Moment, hands.Hand] = Timeline(deeds)
        self._pace = Pace(wanted.speed, wanted.paused, wanted.until_s)
        self._events = [run_event(0.0, {"seed": wanted.seed, "shape": shape.name, "tiles": len(cells)})]
        self._events += [deed_event(time_s, commands.told(deed)) for time_s, deed in deeds]
        for planned in self._timeline.deeds_in(-QUANTUM_S, 0.0):
            self._do_planned(planned)
        self._look()
        self._keep()

    def _instruct(self, port: str, count: int) -> None:
        if self._emulation is None:
            raise UsageError("nothing runs yet; open a drawing first")
        if not self._pace.paused:
            raise UsageError("single instructions are for a run that stands; pause it first")
        tile, now_s = self._array[tile_of(self._board, port)], self._array.time_s
        if not tile.powered:
            raise UsageError(f"{port} has no power, and executes nothing; switch it on first")
        ahead_s = now_s + LONGEST_STEP_S
        if count and (self._emulation.faults.next_s <= ahead_s or self._timeline.deeds_in(now_s, ahead_s)):
            raise UsageError("a planned fault or deed is about to happen; let time go past it, by one update")
        self._stepper.step(tile, count)
        self._timeline.reached(self._array.time_s)
        self._look()
        self._events.append(self._stepper.tell(port, tile))

    def _release(self) -> None:
        """Lets a tile go on that was halted between two instructions, up to the present of the others."""
        if self._emulation is not None and self._stepper.release():
            self._pass_time(QUANTUM_S)

    def _shape(self, cells: Sequence[Place]) -> Shape:
        """The drawing with these cells: one of those offered, or an own one."""
        rows = rows_of(cells)
        known = (one.shape for one in self._drawings if one.shape.rows == rows)
        return next(known, Shape(UNKNOWN, rows, UNKNOWN))

    # --- time ---

    def advance(self, wall_s: float) -> list[StreamEvent]:
        """Runs on at the pace; see `tilenca.page.session.Source`."""
        if self._emulation is not None and not self._resting:
            self._run(self._pace.take(wall_s, self._array.time_s))
        events, self._events = self._events, []
        return events

    @property
    def is_idle(self) -> bool:
        """Whether it is paused, or nobody looks."""
        return self._emulation is None or self._pace.paused or self._resting

    def _run(self, seconds: float) -> None:
        if seconds <= 0:
            return
        self._stepper.release()
        started, before_s = time.perf_counter(), self._array.time_s
        try:
            self._pass_time(seconds)
        except TilencaError:
            self._pace.paused = True
            self._look()
            raise
        took_s = time.perf_counter() - started
        self._pace.ran(self._array.time_s - before_s, took_s, self._array.time_s)
        self._look()
        if self._timeline.is_due(self._array.time_s):
            self._keep()

    def _pass_time(self, seconds: float) -> None:
        """Runs on; in a past that is known, hands do what they did."""
        assert self._emulation is not None
        end_s = self._array.time_s + seconds
        for planned in self._timeline.deeds_in(self._array.time_s, end_s):
            self._emulation.pass_time(max(planned[0] - self._array.time_s, 0.0))
            self._do_planned(planned)
        if end_s > self._array.time_s:
            self._emulation.pass_time(end_s - self._array.time_s)
        self._timeline.reached(self._array.time_s)

    def _keep(self) -> None:
        moment = self._board.save()
        said = self._teller.save()
        size = len(moment.snapshot) + VOICE_BYTES * len(said)
        self._timeline.keep(moment.time_s, _Moment(moment, said), size)

    def _seek(self, time_s: float, forget: bool) -> None:
        """Goes to a time that the run has been at; what hands did until then is done."""
        if self._emulation is None:
            raise UsageError("nothing runs yet; open a drawing first")
        self._release()
        from_s, time_s = self._array.time_s, min(time_s, self._timeline.end_s)
        at_s, moment = self._timeline.nearest(time_s)
        if not at_s <= from_s <= time_s:  # or it is nearer to run on
            self._board.restore(moment.board)
            self._teller.restore(moment.said)
        self._pace.set(self._pace.speed, paused=True)
        self._pass_time(time_s - self._array.time_s)
        if forget:
            self._timeline.end_at(self._array.time_s)
        self._events = [event for event in self._events if "run" in event or "refused" in event]
        self._events += [jump_event(self._array.time_s, from_s, forget), *self._teller.all()]
        self._tell_pace()

    # --- what the page is told ---

    def _look(self) -> None:
        self._events += self._teller.look(frames=0 < self._pace.speed <= FRAMES_SPEED)
        self._tell_pace()

    def _tell_pace(self) -> None:
        if self._emulation is not None:
            pace, now_s = self._pace, self._array.time_s
            self._events.append(pace_event(now_s, pace.speed, pace.paused, pace.share, self._timeline.end_s))

    def abandon(self) -> None:
        """Nothing takes long here."""

    def close(self) -> None:
        """Frees the tiles."""
        if self._emulation is not None:
            self._emulation.array.close()
            self._emulation = None
