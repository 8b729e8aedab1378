"""A table with room for twenty tiles, what is done to it, and what is looked at afterwards."""

import random
from dataclasses import replace
from pathlib import Path

from bench.ordeal_checks import Findings, LinkBooks
from tilenca.base import paths
from tilenca.base.sides import EAST, OFFSETS, SOUTH
from tilenca.emulator import Array, Link, LinkFault, ResetCause
from tilenca.emulator.serve import STOCK_BOOTLOADER
from tilenca.emulator.wiring import cables
from tilenca.protocol.commands import restart_command, set_command
from tilenca.protocol.constants import SETTINGS_SIZE
from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.sentences import HelloSentence, LinkSentence, TileSentence
from tilenca.protocol.settings import Settings, parse_settings, settings_block
from tilenca.shapes.file import Shape, load_task
from tilenca.shapes.glyphs import label_of_glyph

ROWS, COLUMNS = 5, 4
PERIODS_MS = (20, 25, 40)
FIELDS = {"period": "period_ms", "brightness": "brightness"}  # of Settings, by their names on the wire
SLICE_S = 0.05
START_S = 2.5 + 0.5  # boot loader and start, after all is mended
# Of the longest period: within so many a drawing shall be named; a wrong label that stays so many times as
# long beyond them is broken.
UPDATES, PATIENCE = 100, 5
TALKS_WITHIN_S = 1.0
NOISE = 40  # bytes at most
BEGAN_AGAIN = 50  # updates that a tile may have done, of those it counts anew, when it tells so first
# What a programmer says first, by STK500 version 2 (Atmel's AVR068): start, number, size, token, CMD_SIGN_ON,
# sum.
SIGN_ON = bytes((0x1B, 0x01, 0x00, 0x01, 0x0E, 0x01, 0x1B ^ 0x01 ^ 0x01 ^ 0x0E ^ 0x01))

Cell = tuple[int, int]


class Ordeal:
    """A table with room for twenty tiles, all cables laid; tiles that are not there have no power."""

    def __init__(self, elf: Path, seed: int, threads: int) -> None:
        self.draw = random.Random(seed)
        self.task = load_task(paths.DEFAULT_SHAPES)
        self.drawings = [shape for shape in self.task.shapes if len(shape.rows) == ROWS]
        everywhere = Shape("8", ("#" * COLUMNS,) * ROWS, "table")
        self.links = cables(everywhere)
        self.places: dict[Cell, int] = {cell: index for index, cell in enumerate(everywhere.cells)}
        ppm = [self.draw.uniform(-5000, 5000) for _ in self.places]
        boot = STOCK_BOOTLOADER if STOCK_BOOTLOADER.exists() else None
        self.array = Array(elf, len(self.places), self.links, ppm, threads=threads, bootloader=boot)
        # What each tile may have: with every change since the last look, or without those that were lost.
        self.given = {i: {Settings(i + 1, PERIODS_MS[0], 0)} for i in range(len(self.array))}
        for tile in self.array:
            tile.write_eeprom(0, settings_block(tile.index + 1, PERIODS_MS[0], 0))
            tile.powered = False
        self.readers = [LineReader() for _ in self.array]
        self.updates: dict[int, int] = {}
        self.said_s: dict[int, float] = {}
        self.tiles: set[Cell] = set()
        self.harmed: set[tuple[int, int]] = set()
        self.cut: set[tuple[int, int]] = set()
        self.drawing = self.drawings[0]
        self.books = LinkBooks()
        self.findings = Findings()

    def run(self, seconds: float) -> None:
        """Runs the table and reads what its tiles say."""
        end_s = self.array.time_s + seconds
        while self.array.time_s < end_s:
            self.array.run(SLICE_S)
            for tile in self.array:
                for _, sentence in self.readers[tile.index].feed(tile.read_serial()):
                    self._heard(tile.index, sentence)
                if tile.fault:
                    self._broken(tile.fault)

    def _broken(self, what: str) -> None:
        self.findings.broken.append(f"{self.array.time_s:.2f} s: {what}")

    def _heard(self, index: int, sentence: object) -> None:
        if isinstance(sentence, HelloSentence):
            self.updates[index] = 0
        elif isinstance(sentence, TileSentence):
            had = self.updates.get(index, 0)
            if BEGAN_AGAIN < sentence.updates < had:
                self._broken(f"tile {index + 1} counted {had} updates, then {sentence.updates}")
            self.updates[index] = sentence.updates
            self.said_s[index] = self.array.time_s
        elif isinstance(sentence, LinkSentence):
            self.books.hear(index, self.array.time_s, sentence)

    # --- deeds ---

    def deed(self) -> None:
        """Does one thing to the table."""
        kinds = (
            (self.step_to_a_drawing, 8),
            (self.spoil_a_cable, 3),
            (self.cut_a_cable, 2),
            (self.pull_the_plug, 2),
            (self.reset, 2),
            (self.talk_to_the_boot_loader, 1),
            (self.change_a_setting, 3),
            (self.make_noise_on_usb, 2),
            (self.begin_again, 1),
        )
        (chosen,) = self.draw.choices([kind for kind, _ in kinds], [weight for _, weight in kinds])
        chosen()
        self.findings.deeds[chosen.__name__.replace("_", " ")] += 1

    def _a_tile(self) -> int:
        return self.places[self.draw.choice(sorted(self.tiles))]

    def _wanted(self) -> set[Cell]:
        shift = COLUMNS - 1 - max(column for _, column in self.drawing.cells)
        return {(row, column + shift) for row, column in self.drawing.cells}

    def step_to_a_drawing(self) -> None:
        """Puts down or takes away a tile that the drawing has or has not; another drawing when it is done."""
        wanted = self._wanted()
        if self.tiles == wanted:
            self.drawing = self.draw.choice(self.drawings)
            wanted = self._wanted()
        near = {(row + down, column + right) for row, column in self.tiles for down, right in OFFSETS}
        missing = sorted((wanted - self.tiles) & near) or sorted(wanted - self.tiles)
        cell = self.draw.choice(missing or sorted(self.tiles - wanted) or sorted(self.tiles))
        self._put(cell, on=bool(missing))

    def _put(self, cell: Cell, on: bool) -> None:
        self.array[self.places[cell]].powered = on
        (self.tiles.add if on else self.tiles.discard)(cell)
        self.updates.pop(self.places[cell], None)

    def _a_cable(self) -> tuple[int, int]:
        cell = self.draw.randrange(ROWS - 1), self.draw.randrange(COLUMNS - 1)
        return self.places[cell], self.draw.choice((EAST, SOUTH))

    def spoil_a_cable(self) -> None:
        """Lets a cable lose bytes and invert bits."""
        end = self._a_cable()
        fault = LinkFault(loss=self.draw.uniform(0, 0.5), flip=self.draw.choice((0, 1e-3, 1e-2)))
        self.array.set_fault(*end, fault, seed=self.draw.randrange(1 << 16))
        self.harmed.add(end)

    def cut_a_cable(self) -> None:
        """Cuts a cable, or mends one that is cut."""
        end = self._a_cable()
        if end in self.cut:
            self.array.mend(*end)
            self.cut.discard(end)
        else:
            self.array.cut(*end)
            self.cut.add(end)

    def pull_the_plug(self) -> None:
        """Takes the power of a tile, or of all, for a moment."""
        every = self.draw.random() < 0.2
        hit = [self.places[cell] for cell in sorted(self.tiles)] if every else [self._a_tile()]
        for index in hit:
            self.array[index].powered = False
        self.run(self.draw.choice((0.001, 0.05, 0.2)))
        for index in hit:
            self.array[index].powered = True
            self.updates.pop(index, None)

    def reset(self) -> None:
        """Resets a tile, as the USB bridge or a supply that gives way does: the boot loader comes first."""
        index = self._a_tile()
        self.array[index].reset(self.draw.choice((ResetCause.EXTERNAL, ResetCause.BROWN_OUT)))
        self.updates.pop(index, None)

    def talk_to_the_boot_loader(self) -> None:
        """Resets a tile and begins as a programmer does, which then goes away, at times in mid-message."""
        index = self._a_tile()
        self.array[index].reset(ResetCause.EXTERNAL)
        self.updates.pop(index, None)
        self.run(self.draw.choice((0.05, 0.2, 0.4)))
        self.array[index].write_serial(SIGN_ON[: self.draw.choice((2, len(SIGN_ON), len(SIGN_ON)))])

    def change_a_setting(self) -> None:
        """Sends a setting; sometimes the power goes while it is written."""
        index = self._a_tile()
        period_ms, brightness = self.draw.choice(PERIODS_MS), self.draw.randrange(1, 256)
        name, value = self.draw.choice([("period", period_ms), ("brightness", brightness)])
        self.given[index] |= {replace(old, **{FIELDS[name]: value}) for old in self.given[index]}
        self.array[index].write_serial(set_command(name, value))
        if self.draw.random() < 0.3:
            self.run(SLICE_S)
            self.array[index].powered = False
            self.run(SLICE_S)
            self.array[index].powered = True
            self.updates.pop(index, None)

    def make_noise_on_usb(self) -> None:
        """Sends bytes that are no command."""
        self.array[self._a_tile()].write_serial(self.draw.randbytes(self.draw.randrange(1, NOISE)) + b"\r\n")

    def begin_again(self) -> None:
        """Lets a tile begin again from the seed, as its button does."""
        index = self._a_tile()
        self.updates.pop(index, None)
        self.array[index].write_serial(restart_command())

    # --- calm ---

    def calm(self) -> None:
        """Mends everything, completes the drawing, waits, and looks."""
        for end in sorted(self.cut):
            self.array.mend(*end)
        for end in sorted(self.harmed):
            self.array.set_fault(*end, LinkFault())
        self.cut, self.harmed = set(), set()
        for cell in sorted(self._wanted() ^ self.tiles):
            self._put(cell, on=cell not in self.tiles)
        self.run(START_S)
        self.books.forget()
        self.run(UPDATES * max(PERIODS_MS) / 1000)
        self.findings.calms += 1
        for words in self.books.check(self._links_here(), self.findings):
            self._broken(words)
        self._look()
        self._wait_for_the_label()

    def _links_here(self) -> list[Link]:
        here = {self.places[cell] for cell in self.tiles}
        return [link for link in self.links if link[0] in here and link[2] in here]

    def _labels(self) -> list[str]:
        segments = [self.array[self.places[cell]].segments for cell in sorted(self.tiles)]
        return [label_of_glyph(lit, self.task.labels) or "?" for lit in segments]

    def _wait_for_the_label(self) -> None:
        """A drawing that is not named in time is given more; a wrong label that stays even then is broken."""
        if set(labels := self._labels()) == {self.drawing.label}:
            return
        said = f"{self.array.time_s:.2f} s: {self.drawing.label} shows {' '.join(labels)}"
        for _ in range(PATIENCE):
            self.run(UPDATES * max(PERIODS_MS) / 1000)
            if set(self._labels()) == {self.drawing.label}:
                self.findings.late.append(said)
                return
        self._broken(
            f"after {UPDATES * (1 + PATIENCE)} updates {self.drawing.label} shows {' '.join(self._labels())}"
        )

    def _look(self) -> None:
        now_s = self.array.time_s
        for cell in sorted(self.tiles):
            index = self.places[cell]
            tile = self.array[index]
            if now_s - (said_s := self.said_s.get(index, 0)) > TALKS_WITHIN_S:
                self._broken(f"tile {index + 1} is stuck: silent since {said_s:.2f} s")
            found = parse_settings(tile.read_eeprom(0, SETTINGS_SIZE))
            if found is None or found not in self.given[index]:
                self._broken(f"tile {index + 1} has settings that nobody gave it: {found}")
            else:
                self.given[index] = {found}
