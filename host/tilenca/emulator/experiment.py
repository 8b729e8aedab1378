"""One drawing on emulated tiles: lays it out, switches it on, and reads its telemetry until it has converged.

`tilenca.emulator` knows boards and cables; this module knows shapes, settings and telemetry.
"""

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tilenca.base.errors import TilencaError
from tilenca.emulator.array import Array
from tilenca.emulator.board_faults import BoardFault, BoardFaults
from tilenca.emulator.eeprom_files import load_eeprom
from tilenca.emulator.fault_spec import FaultSpec
from tilenca.emulator.hardware import Hardware
from tilenca.emulator.telemetry import heard_from
from tilenca.emulator.tile import EmulatedTile
from tilenca.emulator.types import last_begun
from tilenca.emulator.voice import Voice
from tilenca.emulator.wiring import cables
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import HelloSentence, LinkSentence, TileSentence
from tilenca.protocol.settings import Settings, settings_block
from tilenca.shapes.file import Shape
from tilenca.shapes.glyphs import label_of_glyph

SLICE_S = 0.05
PATIENCE, PATIENCE_S = 1.5, 3.0  # a tile that takes so much longer, and this, will never finish
BOOTLOADER_S = 1.5  # the stock bootloader gives way after a second without a byte; see docs/EMULATOR.md
BYTE_S = 10 / 115200
STEADY_UPDATES = 10  # tiles that were right for so many updates have agreed


@dataclass(frozen=True)
class EmulationSettings:
    """The settings of a run: how tiles are switched on, and for how long they run.

    Attributes:
        seconds: run so long; None: until every tile has done `updates` updates.
        updates: see `seconds`.
        most_updates: go on to so many until all tiles have been right for a while; None: end after `updates`.
        period_ms: written into each tile's settings; None: the firmware's own.
        ppm: clock errors are uniform in -ppm..ppm.
        boot_spread_s: tiles are switched on at times uniform in 0..boot_spread_s.
        seed: of both; each shape draws its own.
        bootloader: image that tiles start in; None: none, and programs begin as soon as there is power.
        unpowered: what a tile without power does to its neighbours' inputs; see `Hardware`.
        faults: to inject.
        threads: how many share the work; they change nothing else.
        eeprom: directory with an EEPROM's contents for each tile that has a file there; None: none.
    """

    seconds: float | None = None
    updates: int = 30
    most_updates: int | None = None
    period_ms: int | None = None
    ppm: float = 3000.0
    boot_spread_s: float = 1.0
    seed: int = 0
    bootloader: Path | None = None
    unpowered: str = "low"
    faults: tuple[FaultSpec | BoardFault, ...] = ()
    threads: int = 1
    eeprom: Path | None = None


class Emulation:
    """The tiles of one shape, running."""

    def __init__(
        self,
        shape: Shape,
        labels: Sequence[str],
        elf: Path,
        settings: EmulationSettings,
        defaults: Settings | None,
    ) -> None:
        """Wires the tiles and writes their settings; nothing runs yet.

        Args:
            shape: what to lay out.
            labels: those of all classes; they tell "5" from "S".
            elf: the firmware image.
            settings: of the run.
            defaults: of `greeting.firmware_settings`; with None tiles get no settings and no number.

        Raises:
            BuildError, UsageError: the image cannot be used, or the emulator is not built.
            UsageError: a fault names a tile or cable that does not exist, or an EEPROM file cannot be used.
        """
        self.shape, self.labels, self.settings = shape, tuple(labels), settings
        count = len(shape.cells)
        draw = random.Random(f"{settings.seed} {shape.name}")
        self.ppm = [draw.uniform(-settings.ppm, settings.ppm) for _ in range(count)]
        self.switch_on_s = [draw.uniform(0.0, settings.boot_spread_s) for _ in range(count)]
        self.cables = links = cables(shape)
        hardware = Hardware(draw.getrandbits(63), unpowered=settings.unpowered)
        self.array = Array(
            elf, count, links, self.ppm, self.switch_on_s, settings.bootloader, settings.threads,
            hardware=hardware,
        )  # fmt: skip
        self.faults = BoardFaults(self.array, links, settings.seed)
        for spec in settings.faults:
            self.faults.add(spec)
        self.period_ms = settings.period_ms or (defaults.period_ms if defaults else None)
        self._voices = [Voice() for _ in range(count)]
        self.hello: HelloSentence | None = None  # the firmware's own greeting, the same from every tile
        for tile in self.array:
            kept = settings.eeprom and load_eeprom(tile, settings.eeprom)
            if self.period_ms is not None and (not kept or settings.period_ms is not None):
                updates = defaults.updates if defaults else 0
                tile.write_eeprom(0, settings_block(tile.index + 1, self.period_ms, updates))

    def advance(self, seconds: float) -> list[Heard]:
        """Runs on and returns the tiles' sentences, in order of time.

        Raises:
            TilencaError: a tile stopped at a fault.
        """
        self.pass_time(seconds)
        return self.listen()

    def pass_time(self, seconds: float) -> None:
        """Runs on, and injects the faults that fall due.

        Raises:
            TilencaError: a tile stopped at a fault of its program.
        """
        for tile in self.faults.run(seconds):
            if tile >= len(self._voices):
                continue  # a hand has put it in; nobody listens to it here
            self._voices[tile].restart()  # its sentences before the reset no longer count
            self.switch_on_s[tile] = self.faults.restarted_s[tile]

    def listen(self) -> list[Heard]:
        """The tiles' sentences since the last call, in order of time; ports are called `tile-01`, ..."""
        heard = []
        for tile, voice in zip(self.array, self._voices, strict=True):
            said = heard_from(tile, voice.reader)
            for line in said:
                self._note(tile.index, line)
            heard += said
        return sorted(heard, key=lambda line: (line.time_s, line.port))

    def _note(self, tile: int, heard: Heard) -> None:
        voice = self._voices[tile]
        if isinstance(heard.sentence, TileSentence):
            said_s = heard.time_s - len(heard.raw) * BYTE_S
            voice.note(heard.sentence, said_s, 1 + self.ppm[tile] * 1e-6)
        elif isinstance(heard.sentence, LinkSentence):
            voice.links[heard.sentence.side] = heard.sentence
        elif isinstance(heard.sentence, HelloSentence):
            self.hello = heard.sentence

    def share_done(self) -> float:
        """The done share of the run, 0 to 1; in updates, that of the least advanced tile."""
        if self.settings.seconds is not None:
            return min(self.array.time_s / self.settings.seconds, 1.0)
        done = self.fewest_updates()
        if done >= self.settings.updates and self._goes_on(done):
            return min(done / (self.settings.most_updates or done), 0.99)
        return min(done / self.settings.updates, 1.0)

    def _goes_on(self, done: int) -> bool:
        """Whether the tiles may take more updates, and have not been right for a while."""
        if self.settings.most_updates is None or done >= self.settings.most_updates:
            return False
        moment_s = self._agreed_moment_s()
        steady_s = STEADY_UPDATES * (self.period_ms or 0) / 1000
        return moment_s is None or self.array.time_s - moment_s < steady_s

    def fewest_updates(self) -> int:
        """The updates of the least advanced tile with power."""
        return min(map(self._updates, self.standing()), default=0)

    def done(self) -> bool:
        """Whether it has run for as long as its settings ask."""
        return self.share_done() >= 1.0

    def run(self, on_slice: Callable[["Emulation", list[Heard]], None], slice_s: float = SLICE_S) -> None:
        """Runs until done, and calls `on_slice` after every slice of it, of so many emulated seconds.

        Raises:
            TilencaError: a tile stopped at a fault, or does not get its updates done.
        """
        limit_s = self._limit_s()
        while not self.done():
            if self.array.time_s > limit_s:
                slowest = min(self.standing(), key=self._updates, default=0)
                done = self._updates(slowest)
                about = f"shape '{self.shape.name}': tile {slowest + 1} reported {done} updates"
                unread = "" if done else "; one that hangs, or a clock 4 % off, is not heard"
                limit = f"in {limit_s:.1f} s instead of {self.settings.updates}"
                raise TilencaError(f"{about} {limit}; give --seconds to run on{unread}")
            left_s = slice_s if self.settings.seconds is None else self.settings.seconds - self.array.time_s
            on_slice(self, self.advance(min(slice_s, max(left_s, 1e-6))))

    def _limit_s(self) -> float:
        if self.settings.seconds is not None:
            return float("inf")
        expected_s = (self.settings.most_updates or self.settings.updates) * (self.period_ms or 0) / 1000
        boot_s = self.settings.boot_spread_s + (BOOTLOADER_S if self.settings.bootloader else 0.0)
        return boot_s + PATIENCE * expected_s + PATIENCE_S

    def standing(self) -> list[int]:
        """The tiles that have power; the others do not count."""
        return [tile.index for tile in self.array if tile.powered]

    def _updates(self, index: int) -> int:
        return self._voices[index].updates

    def without_update(self) -> int:
        """How many tiles with power have not reported an update."""
        return sum(self._updates(index) == 0 for index in self.standing())

    def updates_done(self) -> int:
        """The updates that all tiles together have reported."""
        return sum(self._updates(tile.index) for tile in self.array)

    def label(self, segments: int) -> str:
        """The character that lit segments show; "" for a dark display, "?" for none."""
        return label_of_glyph(segments, self.labels)

    def shown(self, tile: EmulatedTile) -> str:
        """The character a tile's display shows now."""
        return self.label(tile.segments)

    def share_right(self) -> float:
        """Share (0..1) of the tiles with power whose display shows the shape's label now."""
        answers = self.answers()
        return sum(answer == self.shape.label for answer in answers) / max(len(answers), 1)

    def answers(self) -> list[str]:
        """The characters that the displays of the tiles with power show now."""
        return [self.shown(self.array[index]) for index in self.standing()]

    @property
    def all_right(self) -> bool:
        """Whether every tile that has power shows the shape's label now."""
        return set(self.answers()) == {self.shape.label}

    def agreed_at_s(self) -> float | None:
        """Time from the last switch-on until all tiles stay right; None if they do not."""
        moment_s = self._agreed_moment_s()
        return None if moment_s is None else moment_s - max(self.switch_on_s)

    def agreed_after_update_s(self) -> float | None:
        """Time from the first update of the last tile until all tiles stay right; None if they do not."""
        moment_s = self._agreed_moment_s()
        first_s = [self._voices[index].first_update_s for index in self.standing()]
        if moment_s is None or None in first_s:
            return None
        return max(0.0, moment_s - max(time_s for time_s in first_s if time_s is not None))

    def _agreed_moment_s(self) -> float | None:
        return max(self.right_from_s(self.standing())) if self.all_right else None

    def right_from_s(self, tiles: Sequence[int]) -> list[float]:
        """When each of some tiles, which are right now, began to show the shape's label."""
        changes = (self.array[tile].display_changes for tile in tiles)
        return [last_begun(each, lambda lit: self.label(lit) == self.shape.label) for each in changes]

    def agreed_at_update(self) -> int | None:
        """The updates of the least advanced tile when all agreed; None if they do not."""
        moment_s = self._agreed_moment_s()
        if moment_s is None:
            return None
        return min(
            self._voices[index].updates_at(moment_s, 1 + self.ppm[index] * 1e-6) for index in self.standing()
        )

    def report(self, wall_s: float) -> dict[str, Any]:
        """The JSON document of one shape."""
        agreed_s, after_update_s = self.agreed_at_s(), self.agreed_after_update_s()
        return {
            "shape": self.shape.name,
            "model_id": self.hello and f"{self.hello.model_id:04X}",
            "firmware_id": self.hello and f"{self.hello.firmware_id:08X}",
            "simulated_s": round(self.array.time_s, 6),
            "wall_s": round(wall_s, 3),
            "tiles": [self._tile_report(tile) for tile in self.array],
            "all_right": self.all_right,
            "agreed_at_s": None if agreed_s is None else round(agreed_s, 6),
            "agreed_after_first_update_s": None if after_update_s is None else round(after_update_s, 6),
            "agreed_at_update": self.agreed_at_update(),
        }

    def _tile_report(self, tile: EmulatedTile) -> dict[str, Any]:
        row, col = self.shape.cells[tile.index]
        return {
            "id": tile.index + 1,
            "row": row,
            "col": col,
            "shown": self.shown(tile),
            "rgb": list(tile.rgb),
            "updates": self._updates(tile.index),
            "frames": self._voices[tile.index].frames(),
        }
