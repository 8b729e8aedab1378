"""Emulated tiles in the places of a board, rearranged by hand while they run."""

import random
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from tilenca.base.errors import UsageError
from tilenca.base.sides import EAST, OFFSETS, SIDES, SOUTH, opposite
from tilenca.emulator.array import Link
from tilenca.emulator.experiment import Emulation
from tilenca.emulator.faults import FaultsMoment
from tilenca.emulator.traffic import Traffic
from tilenca.protocol.commands import set_command
from tilenca.protocol.settings import settings_block
from tilenca.protocol.stream_fields import MAX_PLACE

# Row and column on the board; any whole numbers.
Place: TypeAlias = tuple[int, int]
# A tile stops at its number of updates: at once, where it has done more.
STOPPED_UPDATES = 1
FOR_EVER = 0


@dataclass(frozen=True)
class BoardMoment:
    """A board at a moment: all that decides about its future.

    Attributes:
        time_s: emulated seconds since the run began.
        snapshot: of the array.
        places: of the tiles on the board, by their index.
        cables: between them.
        faults: that stand, and that will fall due.
    """

    time_s: float
    snapshot: bytes
    places: dict[int, Place]
    cables: list[Link]
    faults: FaultsMoment


class Arrangement:
    """Which tile lies where, and what a hand may do about it.

    A tile that is taken out keeps its number and lies in the box; the next one that is put in is the one of
    the box with the lowest number, or a new one.

    Attributes:
        places: of the tiles on the board, by their index.
        traffic: on the cables.
    """

    def __init__(self, emulation: Emulation, cells: Sequence[Place]) -> None:
        """Takes over the tiles of a laid-out shape; `cells` are their places, in reading order."""
        self._emulation, self._array = emulation, emulation.array
        self.places: dict[int, Place] = dict(enumerate(cells))
        self.traffic = Traffic(self._array, emulation.cables)

    # --- questions ---

    def tile_at(self, place: Place) -> int | None:
        """The tile that lies there."""
        return next((tile for tile, other in self.places.items() if other == place), None)

    def cable(self, tile: int, side: int) -> Link:
        """The cable at a side.

        Raises:
            UsageError: there is none.
        """
        for link in self._emulation.cables:
            if (tile, side) in (link[:2], link[2:]):
                return link
        raise UsageError(f"tile {tile + 1} has no neighbour in the {SIDES[side]}")

    # --- tiles ---

    def put(self, place: Place) -> int:
        """Plugs a tile in at a place, and switches it on; returns its index.

        Raises:
            UsageError: a tile lies there.
        """
        if self.tile_at(place) is not None:
            raise UsageError("another tile lies there; choose an empty place")
        in_box = [tile.index for tile in self._array if tile.index not in self.places]
        tile = min(in_box) if in_box else self._new_tile()
        if (period_ms := self._emulation.period_ms) is not None:
            self._array[tile].write_eeprom(0, settings_block(tile + 1, period_ms, FOR_EVER))
        self._emulation.faults.power(tile, True)
        self._plug_in(tile, place)
        return tile

    def pull(self, tile: int) -> None:
        """Takes a tile away, with its cables."""
        self._unplug([link for link in self._emulation.cables if tile in (link[0], link[2])])
        self._emulation.faults.power(tile, False)
        self._emulation.faults.lay_straight(tile, True)
        del self.places[tile]

    def move(self, tile: int, place: Place) -> None:
        """Takes a tile out and plugs it in elsewhere: it boots there.

        Raises:
            UsageError: another tile lies there.
        """
        if self.tile_at(place) not in (None, tile):
            raise UsageError("another tile lies there; choose an empty place")
        if self.places[tile] != place:
            self.pull(tile)
            self._emulation.faults.power(tile, True)
            self._plug_in(tile, place)

    def shift(self, tiles: Collection[int], rows: int, cols: int) -> None:
        """Moves tiles together: they keep their power and the cables between them, and run on.

        Raises:
            UsageError: other tiles lie there, or the board ends before.
        """
        there = {tile: (self.places[tile][0] + rows, self.places[tile][1] + cols) for tile in tiles}
        if any(self.tile_at(place) not in (None, *there) for place in there.values()):
            raise UsageError("other tiles lie there; choose empty places")
        if any(abs(number) > MAX_PLACE for place in there.values() for number in place):
            raise UsageError(f"the board ends there; rows and columns are -{MAX_PLACE} to {MAX_PLACE}")
        self._unplug([link for link in self._emulation.cables if (link[0] in there) != (link[2] in there)])
        self.places.update(there)
        for tile in sorted(there):
            self._join(tile, there)

    def arrange(self, cells: Collection[Place]) -> None:
        """Makes another drawing: takes out what is too much, puts in what is missing; the rest runs on."""
        for tile in [tile for tile, place in self.places.items() if place not in cells]:
            self.pull(tile)
        for place in sorted(set(cells) - set(self.places.values())):
            self.put(place)

    def power(self, tile: int, on: bool) -> None:
        """Switches a tile on or off where it lies."""
        self._emulation.faults.power(tile, on)

    def reset(self, tile: int) -> None:
        """Starts a tile's program anew."""
        self._emulation.faults.reset(tile)

    def started_s(self, tile: int) -> float:
        """When a tile was switched on or reset last; below 0 where it never was since the beginning."""
        return self._emulation.faults.restarted_s.get(tile, -1.0)

    def freeze(self, tile: int, on: bool) -> None:
        """Tells a tile over USB to update no more, or for ever; until then it does as before."""
        self.tell(tile, set_command("updates", STOPPED_UPDATES if on else FOR_EVER))

    def tell(self, tile: int, command: bytes) -> None:
        """Sends a tile a command over USB."""
        self._array[tile].write_serial(command)

    def turn(self, tile: int, on: bool) -> None:
        """Turns a tile by 90 degrees, or back; it runs on."""
        self._emulation.faults.lay_straight(tile, not on)

    def skew(self, tile: int, ppm: float) -> None:
        """From now on a tile's clock is so much faster than it was made."""
        self._emulation.faults.skew(tile, ppm)

    def fault_of(self, tile: int) -> tuple[bool, float]:
        """Whether a tile lies turned, and by how many ppm its clock is too fast."""
        faults = self._emulation.faults
        return tile in faults.turned, faults.skewed.get(tile, 0.0)

    # --- cables ---

    @property
    def cut(self) -> set[Link]:
        """The cables that are cut now."""
        cut = self._emulation.faults.cut
        return {link for link in self._emulation.cables if link[:2] in cut or link[2:] in cut}

    def connect(self, tile: int, side: int, whole: bool) -> None:
        """Cuts or mends a cable.

        Raises:
            UsageError: there is none.
        """
        link = self.cable(tile, side)
        if whole:
            self._emulation.faults.cut.discard(link[2:])  # a fault may have named its other end
        self._emulation.faults.connect(link[:2], whole)

    def lose(self, share: float) -> None:
        """From now on so many of the bytes on all cables are lost, 0..1."""
        self._emulation.faults.spoil_all("loss", share)

    # --- moments ---

    def save(self) -> BoardMoment:
        """The board as it is now."""
        emulation = self._emulation
        return BoardMoment(
            self._array.time_s,
            self._array.save(),
            dict(self.places),
            list(emulation.cables),
            emulation.faults.save(),
        )

    def restore(self, moment: BoardMoment) -> None:
        """Goes to a moment of this board; from there the same happens as did then."""
        self._array.restore(moment.snapshot)
        self.places = dict(moment.places)
        self._emulation.cables[:] = moment.cables  # the faults know this list, too
        self._emulation.faults.restore(moment.faults)
        self.traffic.restart(moment.cables)

    # --- how ---

    def _new_tile(self) -> int:
        settings = self._emulation.settings
        index = len(self._array)
        ppm = random.Random(f"{settings.seed} tile {index}").uniform(-settings.ppm, settings.ppm)
        self._array.add_tile(ppm)
        return index

    def _unplug(self, links: Collection[Link]) -> None:
        for link in links:
            self._array.unlink(*link[:2])
            self.traffic.forget(link)
            self._emulation.cables.remove(link)
            self._emulation.faults.cut -= {link[:2], link[2:]}

    def _plug_in(self, tile: int, place: Place) -> None:
        self.places[tile] = place
        self._join(tile)

    def _join(self, tile: int, joined: Collection[int] = ()) -> None:
        """Plugs in the cables to its neighbours, but to those that are joined with it already."""
        row, col = self.places[tile]
        for side, (down, right) in enumerate(OFFSETS):
            other = self.tile_at((row + down, col + right))
            if other is None or other in joined:
                continue
            link = (tile, side, other, opposite(side))
            if side not in (EAST, SOUTH):
                link = (*link[2:], *link[:2])
            self._array.link(*link)
            self._emulation.cables.append(link)
            self.traffic.watch(link)
            self._emulation.faults.plug_in(link)
