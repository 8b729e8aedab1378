"""The native emulator behind the page: one run at a time, in any speed, with hands in it."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tilenca.base.errors import TilencaError, UsageError
from tilenca.base.sides import SIDES
from tilenca.emulator.arrangement import Arrangement, Place
from tilenca.emulator.array import Link
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.faults import parse as parse_fault
from tilenca.emulator.telemetry import heard_from
from tilenca.emulator.types import port_name
from tilenca.page.offer import Drawing
from tilenca.page.pace import Pace
from tilenca.protocol import stream_commands as commands
from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.settings import Settings
from tilenca.protocol.stream import (
    StreamEvent,
    cable_event,
    display_event,
    frame_event,
    open_event,
    pace_event,
    place_event,
    raw_event,
    run_event,
    stream_event,
)
from tilenca.shapes.edits import rows_of
from tilenca.shapes.file import UNKNOWN, Shape
from tilenca.shapes.glyphs import looks_of

# Up to this speed there is time to look at single frames on the cables.
FRAMES_SPEED = 0.3
NO_POWER = "no power"


@dataclass
class _Seen:
    """What the page has been told of one tile."""

    place: Place | None = None
    powered: bool | None = None
    display: tuple[int, tuple[int, ...], str] | None = None


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
                most_tiles=commands.MOST_TILES,
                most_place=commands.MAX_PLACE,
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
            case commands.Seen():
                raise UsageError("seen: the server takes it itself")
            case _:
                self._lay_hands_on(command)
        self._tell_places()

    def _lay_hands_on(self, command: commands.StreamCommand) -> None:
        if self._emulation is None:
            raise UsageError("nothing runs yet; open a drawing first")
        board = self._board
        match command:
            case commands.Put(row, col):
                self._check_room(1)
                board.put((row, col))
            case commands.Pull(port):
                board.pull(self._tile(port))
            case commands.Move(port, row, col):
                board.move(self._tile(port), (row, col))
            case commands.Arrange(cells):
                board.arrange(cells)
            case commands.Cut(port, side, on):
                board.connect(self._tile(port), SIDES.index(side), not on)
            case commands.Power(port, on):
                self._array[self._tile(port)].powered = on
            case commands.Freeze(port, on):
                board.freeze(self._tile(port), on)
            case commands.Reset(port):
                self._array[self._tile(port)].reset()
            case commands.Noise(loss):
                board.lose(loss)

    def _check_room(self, more: int) -> None:
        if len(self._board.places) + more > commands.MOST_TILES:
            raise UsageError(f"the board has {commands.MOST_TILES} tiles, which is all; take one out first")

    def _tile(self, port: str) -> int:
        """The tile of that port, which lies on the board."""
        for tile in self._board.places:
            if port_name(tile) == port:
                return tile
        raise UsageError(f"no tile {port} lies on the board")

    def _open(self, wanted: commands.Open) -> None:
        faults = tuple(parse_fault(text) for text in wanted.faults)
        cells = sorted(wanted.cells)
        settings = EmulationSettings(boot_spread_s=wanted.spread_s, seed=wanted.seed, faults=faults)
        shape = self._shape(cells)
        emulation = Emulation(shape, self._labels, self._image, settings, self._defaults)
        self.close()
        self._emulation = emulation
        self._array = emulation.array
        self._board = Arrangement(emulation, cells)
        self._readers: list[LineReader] = []
        self._seen: list[_Seen] = []
        self._seen_cut: set[Link] = set()
        self._pace = Pace(wanted.speed, wanted.paused, wanted.until_s)
        self._events = [run_event(0.0, {"seed": wanted.seed, "shape": shape.name, "tiles": len(cells)})]
        self._look()

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
        assert self._emulation is not None
        started, before_s = time.perf_counter(), self._array.time_s
        try:
            self._emulation.pass_time(seconds)
        except TilencaError:
            self._pace.paused = True
            self._look()
            raise
        took_s = time.perf_counter() - started
        self._pace.ran(self._array.time_s - before_s, took_s, self._array.time_s)
        self._look()

    # --- what the page is told ---

    def _look(self) -> None:
        now_s = self._array.time_s
        self._tell_places()
        frames = self._board.traffic.read()
        if 0 < self._pace.speed <= FRAMES_SPEED:
            self._events += [
                frame_event(frame.time_s, port_name(frame.tile), SIDES[frame.side], frame.data)
                for frame in frames
            ]
        heard = [
            line
            for tile, reader in zip(self._array, self._readers, strict=True)
            for line in heard_from(tile, reader)
        ]
        heard.sort(key=lambda line: (line.time_s, line.port))
        self._events += [raw_event(line.time_s, line.port, line.raw) for line in heard]
        for tile, seen in zip(self._array, self._seen, strict=True):
            leds = "".join(name if lit else "-" for name, lit in zip(SIDES, tile.leds, strict=True))
            display = tile.segments, tile.rgb, leds
            if display != seen.display:
                seen.display = display
                self._events.append(display_event(now_s, port_name(tile.index), *display))
        self._tell_pace()

    def _tell_places(self) -> None:
        """What lies where, has power, and is joined, as far as it is news."""
        if self._emulation is None:
            return
        now_s = self._array.time_s
        while len(self._seen) < len(self._array):
            self._seen.append(_Seen())
            self._readers.append(LineReader())
        for tile, seen in zip(self._array, self._seen, strict=True):
            port, place = port_name(tile.index), self._board.places.get(tile.index)
            if place != seen.place:
                seen.place = place
                self._events.append(place_event(now_s, port, place))
            if place is not None and tile.powered != seen.powered:
                seen.powered = tile.powered
                self._events.append(open_event(now_s, port, tile.powered, "" if tile.powered else NO_POWER))
        cut = self._board.cut
        for link in sorted(cut ^ self._seen_cut):
            self._events.append(cable_event(now_s, port_name(link[0]), SIDES[link[1]], link not in cut))
        self._seen_cut = cut

    def _tell_pace(self) -> None:
        if self._emulation is not None:
            pace = self._pace
            self._events.append(pace_event(self._array.time_s, pace.speed, pace.paused, pace.share))

    def close(self) -> None:
        """Frees the tiles."""
        if self._emulation is not None:
            self._emulation.array.close()
            self._emulation = None
