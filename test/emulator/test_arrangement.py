"""A hand in running tiles: what is pulled, put, moved, cut and slid under does what real tiles would."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest

from tilenca.base.errors import UsageError
from tilenca.base.sides import EAST, NORTH, SOUTH, WEST
from tilenca.emulator.arrangement import Arrangement
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.fault_spec import parse as parse_fault
from tilenca.emulator.greeting import firmware_settings
from tilenca.shapes.file import Shape

LABELS = tuple("0123456789")
ROW_OF_THREE = ("###",)
Make = Callable[..., tuple[Emulation, Arrangement]]


@contextmanager
def arranged(
    firmware: Path, rows: Sequence[str], **settings: object
) -> Iterator[tuple[Emulation, Arrangement]]:
    shape = Shape("-", tuple(rows), "-")
    wanted = EmulationSettings(boot_spread_s=0.0, **settings)  # type: ignore[arg-type]
    emulation = Emulation(shape, LABELS, firmware, wanted, firmware_settings(firmware))
    with emulation.array:
        yield emulation, Arrangement(emulation, shape.cells)


def links(emulation: Emulation, tile: int) -> str:
    return "".join(name if lit else "-" for name, lit in zip("NESW", emulation.array[tile].leds, strict=True))


def test_a_pulled_tile_is_dark_and_its_neighbours_notice(firmware: Path) -> None:
    with arranged(firmware, ROW_OF_THREE) as (emulation, board):
        emulation.pass_time(0.3)
        assert [links(emulation, tile) for tile in range(3)] == ["-E--", "-E-W", "---W"]
        board.pull(1)
        emulation.pass_time(0.3)
        assert [links(emulation, tile) for tile in (0, 2)] == ["----", "----"]
        assert emulation.array[1].segments == 0
        assert board.places == {0: (0, 0), 2: (0, 2)}
        assert emulation.cables == []


def test_the_tile_in_the_box_is_put_in_before_a_new_one(firmware: Path) -> None:
    with arranged(firmware, ROW_OF_THREE) as (emulation, board):
        emulation.pass_time(0.1)
        board.pull(1)
        assert board.put((1, 0)) == 1
        assert board.put((0, 1)) == 3
        assert len(emulation.array) == 4
        emulation.pass_time(0.4)
        assert [links(emulation, tile) for tile in range(4)] == ["-ES-", "N---", "---W", "-E-W"]


def test_a_moved_tile_boots_and_keeps_its_number(firmware: Path) -> None:
    with arranged(firmware, ROW_OF_THREE) as (emulation, board):
        emulation.pass_time(0.3)
        emulation.listen()
        board.move(2, (-1, 0))
        emulation.pass_time(0.4)
        lines = [line for line in emulation.listen() if line.port == "tile-03"]
        said = [line.raw for line in lines if line.sentence is not None]  # what it was just saying is cut off
        assert said[0].startswith(b"$HELLO,3,3,")
        assert links(emulation, 2) == "--S-"
        with pytest.raises(UsageError, match="another tile lies there"):
            board.move(2, (0, 0))
        board.move(2, (-1, 0))  # where it lies: nothing happens
        emulation.pass_time(0.05)
        assert not any(b"HELLO" in line.raw for line in emulation.listen())


def test_tiles_that_are_shifted_keep_their_cables_and_run_on(firmware: Path) -> None:
    with arranged(firmware, ("###", "...", "###")) as (emulation, board):
        emulation.pass_time(0.3)
        emulation.listen()
        board.connect(1, WEST, whole=False)
        board.shift([0, 1, 2], 1, 1)
        assert [board.places[tile] for tile in range(3)] == [(1, 1), (1, 2), (1, 3)]
        assert board.cut == {(0, EAST, 1, WEST)}
        assert set(emulation.cables[-2:]) == {(0, SOUTH, 4, NORTH), (1, SOUTH, 5, NORTH)}
        emulation.pass_time(0.3)
        assert [links(emulation, tile) for tile in range(6)] == [
            "--S-",
            "-ES-",
            "---W",
            "-E--",
            "NE-W",
            "N--W",
        ]
        board.shift([0, 1, 2], 0, 1)
        assert emulation.cables[-1] == (0, SOUTH, 5, NORTH)
        emulation.pass_time(0.3)
        assert [links(emulation, tile) for tile in (1, 4, 5)] == ["-E--", "-E-W", "N--W"]
        assert not any(line.raw.startswith(b"$HELLO") for line in emulation.listen())


def test_a_shift_needs_room(firmware: Path) -> None:
    with arranged(firmware, ROW_OF_THREE) as (_, board):
        with pytest.raises(UsageError, match="other tiles lie there; choose empty places"):
            board.shift([0, 1], 0, 1)
        with pytest.raises(UsageError, match="the board ends there"):
            board.shift([0, 1, 2], 0, 63)
        assert board.places == {0: (0, 0), 1: (0, 1), 2: (0, 2)}
        board.shift([0, 1, 2], 0, 62)
        assert board.places[2] == (0, 64)


def test_a_place_holds_one_tile(firmware: Path) -> None:
    with arranged(firmware, ROW_OF_THREE) as (_, board), pytest.raises(UsageError, match="empty place"):
        board.put((0, 0))


def test_a_drawing_slides_under_and_what_lies_in_both_runs_on(firmware: Path) -> None:
    with arranged(firmware, ROW_OF_THREE) as (emulation, board):
        emulation.pass_time(0.3)
        emulation.listen()
        board.arrange([(0, 1), (0, 2), (1, 1)])
        emulation.pass_time(0.2)
        booted = {line.port for line in emulation.listen() if line.raw.startswith(b"$HELLO")}
        assert booted == {"tile-01"}  # out of the box again
        assert board.places == {1: (0, 1), 2: (0, 2), 0: (1, 1)}


def test_a_cable_is_cut_and_mended_from_either_end(firmware: Path) -> None:
    with arranged(firmware, ROW_OF_THREE) as (emulation, board):
        emulation.pass_time(0.3)
        board.connect(1, WEST, whole=False)
        assert board.cut == {(0, EAST, 1, WEST)}
        emulation.pass_time(0.3)
        assert links(emulation, 0) == "----"
        board.connect(0, EAST, whole=True)
        assert board.cut == set()
        emulation.pass_time(0.3)
        assert links(emulation, 0) == "-E--"
        with pytest.raises(UsageError, match="tile 1 has no neighbour in the N"):
            board.connect(0, NORTH, whole=False)


def test_a_cable_goes_with_its_tile_and_comes_back_whole(firmware: Path) -> None:
    with arranged(firmware, ROW_OF_THREE) as (emulation, board):
        board.connect(0, EAST, whole=False)
        board.pull(1)
        assert board.cut == set()
        board.put((0, 1))
        emulation.pass_time(0.4)
        assert links(emulation, 0) == "-E--"


def test_losses_hold_for_cables_that_come_later(firmware: Path) -> None:
    with arranged(firmware, ROW_OF_THREE) as (emulation, board):
        board.lose(1.0)
        board.put((1, 1))
        emulation.pass_time(0.4)
        assert [links(emulation, tile) for tile in range(4)] == ["----"] * 4
        board.lose(0.0)
        emulation.pass_time(0.4)
        assert links(emulation, 1) == "-ESW"


@pytest.mark.parametrize("when", ["", ":0-0.6", ":0.3-0.6"])
def test_losses_that_the_run_began_with_hold_for_cables_that_come_later(firmware: Path, when: str) -> None:
    faults = (parse_fault(f"loss=1{when}"),)
    with arranged(firmware, ROW_OF_THREE, faults=faults) as (emulation, board):
        emulation.pass_time(0.2)
        board.put((1, 1))  # tile 4, in the south of tile 2
        emulation.pass_time(0.2)
        board.move(2, (1, 0))
        emulation.pass_time(0.19)
        assert [links(emulation, tile) for tile in (2, 3)] == ["----"] * 2
        emulation.pass_time(0.4)
        whole = ["NE--", "N--W"] if when else ["----"] * 2
        assert [links(emulation, tile) for tile in (2, 3)] == whole


def test_a_new_cable_has_no_fault_of_the_one_that_lay_there(firmware: Path) -> None:
    with arranged(firmware, ROW_OF_THREE, faults=(parse_fault("loss=1@1-2"),)) as (emulation, board):
        emulation.pass_time(0.3)
        assert links(emulation, 0) == "----"
        board.pull(1)
        board.put((0, 1))
        board.connect(0, EAST, whole=True)
        emulation.pass_time(0.4)
        assert links(emulation, 0) == "-E--"


def test_a_frozen_tile_updates_no_more_and_goes_on_when_it_thaws(firmware: Path) -> None:
    def updates(emulation: Emulation) -> int:
        fields = [line.raw.split(b",") for line in emulation.listen() if line.raw.startswith(b"$TILE,1,")]
        return int(fields[-1][3])

    with arranged(firmware, ROW_OF_THREE) as (emulation, board):
        emulation.pass_time(0.3)
        board.freeze(0, on=True)
        emulation.pass_time(0.3)
        frozen = updates(emulation)
        emulation.pass_time(0.3)
        assert updates(emulation) == frozen
        assert links(emulation, 1) == "-E-W"  # it still speaks
        board.freeze(0, on=False)
        emulation.pass_time(0.5)
        assert updates(emulation) > frozen + 10


def test_the_same_hands_do_the_same_to_the_byte(firmware: Path) -> None:
    def snapshot(slices: int) -> bytes:
        with arranged(firmware, ("##", "##"), seed=5) as (emulation, board):
            for _ in range(slices):
                emulation.pass_time(0.24 / slices)
            board.pull(3)
            board.put((0, 2))
            board.connect(0, SOUTH, whole=False)
            emulation.pass_time(0.2)
            return emulation.array.save()

    assert snapshot(1) == snapshot(15)


def test_a_moment_brings_back_the_board_with_its_cables_and_faults(firmware: Path) -> None:
    faults = (parse_fault("cut@1-2:0.3"), parse_fault("loss=0.2:0.1"))
    with arranged(firmware, ROW_OF_THREE, faults=faults) as (emulation, board):
        emulation.pass_time(0.2)
        moment = board.save()
        emulation.pass_time(0.4)
        after = emulation.array.save()
        board.pull(1)
        board.put((5, 5))
        board.put((0, 1))
        board.lose(0.9)
        emulation.pass_time(0.1)
        board.restore(moment)
        assert board.places == {0: (0, 0), 1: (0, 1), 2: (0, 2)}
        assert (len(emulation.array), board.cut) == (3, set())
        board.traffic.read()
        emulation.pass_time(0.4)
        assert emulation.array.save() == after
        assert board.cut == {(0, EAST, 1, WEST)}
        assert {(frame.tile, frame.side) for frame in board.traffic.read()} >= {(1, EAST), (2, WEST)}
