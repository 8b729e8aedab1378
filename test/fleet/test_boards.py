"""Which board is behind a port, when ports change and adapters are alike."""

import json
import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from serial.tools.list_ports_common import ListPortInfo

from tilenca.base.errors import NoDeviceError, UsageError
from tilenca.cli import main
from tilenca.fleet import ports
from tilenca.fleet.boards import (
    board_name,
    find_boards,
    find_fleet,
    match,
    names_now,
    ports_on_usb,
    tell_contradiction,
    tell_models,
    tile_numbers,
)
from tilenca.fleet.ports import Port
from tilenca.fleet.tiles_file import Place, write_tiles
from tilenca.protocol.sentences import HelloSentence


def usb(
    device: str, serial_number: str | None, location: str, ids: tuple[int, int] = (0x1A86, 0x7523)
) -> ListPortInfo:
    info = ListPortInfo(device)
    info.vid, info.pid = ids
    info.serial_number, info.location = serial_number, location
    return info


MEGA = (0x2341, 0x0042)
LAB = [
    usb("/dev/ttyACM0", "855", "1-1", MEGA),
    usb("/dev/ttyUSB0", None, "1-2.1"),
    usb("/dev/ttyUSB1", "", "1-2.2"),
    usb("/dev/ttyUSB2", "A50285BI", "1-2.3", (0x0403, 0x6001)),
    usb("/dev/ttyUSB10", "A50285BI", "1-2.4", (0x0403, 0x6001)),
]


@pytest.fixture
def lab(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[ListPortInfo]:
    """What is on USB; the test may change the list. No file of tiles but the test's own."""
    infos = list(LAB)
    monkeypatch.setattr(ports, "comports", lambda: infos)
    monkeypatch.chdir(tmp_path)
    return infos


def test_boards_are_told_apart_by_serial_number_and_else_by_their_socket(lab: list[ListPortInfo]) -> None:
    found = find_boards([], None)
    assert [(board.port.name, board.name) for board in found.boards] == [
        ("/dev/ttyACM0", "serial:855"),
        ("/dev/ttyUSB0", "location:1-2.1"),
        ("/dev/ttyUSB1", "location:1-2.2"),
        ("/dev/ttyUSB2", "location:1-2.3"),
        ("/dev/ttyUSB10", "location:1-2.4"),
    ]


def test_a_board_is_the_same_tile_when_its_port_has_another_name(lab: list[ListPortInfo]) -> None:
    write_tiles(Path("tiles.toml"), [Place(7, "serial:855", 0, 0), Place(8, "location:1-2.1", 0, 1)])
    lab[:] = [usb("/dev/ttyACM5", "855", "3-1", MEGA), usb("/dev/ttyUSB9", None, "1-2.1")]
    assert {board.port.name: board.tile for board in find_boards([], None).boards} == {
        "/dev/ttyACM5": 7,
        "/dev/ttyUSB9": 8,
    }


def test_the_file_is_the_fleet_others_are_left_alone_and_missing_ones_told(
    lab: list[ListPortInfo], capsys: pytest.CaptureFixture[str]
) -> None:
    write_tiles(Path("tiles.toml"), [Place(7, "serial:855", 0, 0), Place(8, "location:9-9", 0, 1)])
    found = find_boards([], None)
    assert [board.tile for board in found.boards] == [7]
    assert [place.tile for place in found.missing] == [8]
    assert len(found.others) == 4
    found.tell_others()
    assert "left alone" in capsys.readouterr().err


def test_a_serial_number_that_two_boards_have_by_now_names_none(lab: list[ListPortInfo]) -> None:
    write_tiles(Path("tiles.toml"), [Place(7, "serial:A50285BI", 0, 0), Place(1, "serial:855", 0, 1)])
    found = find_boards([], None)
    assert [board.tile for board in found.boards] == [1]
    assert [place.tile for place in found.missing] == [7]


def test_learning_knows_boards_by_their_names_now_and_each_once(lab: list[ListPortInfo]) -> None:
    boards = match(ports_on_usb(), [], ports_on_usb())
    old = [
        Place(1, "serial:855", 0, 0),
        Place(2, "location:1-1", 0, 1),
        Place(7, "serial:A50285BI", 0, 2),
        Place(8, "location:1-2.3", 0, 3),
    ]
    known = names_now(old, boards, ports_on_usb())
    assert [(place.tile, place.board) for place in known] == [
        (1, "serial:855"),
        (7, "serial:A50285BI"),
        (8, "location:1-2.3"),
    ]


def test_no_listed_tile_at_all_is_no_device(lab: list[ListPortInfo]) -> None:
    write_tiles(Path("tiles.toml"), [Place(7, "serial:other", 0, 0)])
    with pytest.raises(NoDeviceError, match=r"of the 1 tile that tiles.toml lists, none is connected"):
        find_fleet([], None)


@pytest.mark.parametrize("there", [[], LAB])
def test_devices_names_the_listed_tiles_even_when_all_are_gone(
    there: list[ListPortInfo], lab: list[ListPortInfo], capsys: pytest.CaptureFixture[str]
) -> None:
    lab[:] = there
    write_tiles(Path("tiles.toml"), [Place(7, "serial:other", 0, 0)])
    assert main(["devices", "--json"]) == (0 if there else 3)
    captured = capsys.readouterr()
    assert [tile["tile"] for tile in json.loads(captured.out)["missing"]] == [7]
    assert "tile 7 (serial:other): not connected\n" in captured.err
    assert there or "of the 1 tile that tiles.toml lists, none is connected" in captured.err


def test_a_file_without_a_tile_is_named(lab: list[ListPortInfo], capsys: pytest.CaptureFixture[str]) -> None:
    write_tiles(Path("tiles.toml"), [])
    assert main(["devices"]) == 2
    assert "tiles.toml: lists no tile; write it with" in capsys.readouterr().err


def test_a_device_has_one_name_from_whatever_folder_it_is_named(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    name = f"{tmp_path}/deep/../tile-01"
    assert board_name(Port(name), []) == board_name(Port(f"{tmp_path}/tile-01"), [])


@pytest.fixture
def pty() -> Iterator[str]:
    master, slave = os.openpty()
    yield os.ttyname(slave)
    os.close(master)
    os.close(slave)


def test_a_device_that_is_not_on_usb_is_found_by_its_name(
    lab: list[ListPortInfo], pty: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lab.clear()
    link = tmp_path / "tile-01"
    link.symlink_to(pty)
    write_tiles(tmp_path / "lab.toml", [Place(3, f"port:{link}", 4, 2), Place(4, "serial:none", 4, 3)])
    assert main(["devices", "--json", "--tiles", "lab.toml"]) == 0
    captured = capsys.readouterr()
    document = json.loads(captured.out)
    assert [(d["port"], d["tile"], d["row"], d["col"]) for d in document["devices"]] == [("tile-01", 3, 4, 2)]
    assert [(d["board"], d["about"]) for d in document["devices"]] == [(f"port:{link}", "pseudo-terminal")]
    assert document["missing"] == [{"tile": 4, "row": 4, "col": 3, "board": "serial:none"}]
    assert captured.err == "tile 4 (serial:none): not connected\n"


def test_a_board_on_usb_that_the_file_lists_by_its_path_is_one_board(
    lab: list[ListPortInfo], pty: str, tmp_path: Path
) -> None:
    link = tmp_path / "by-id"
    link.symlink_to(pty)
    lab.append(usb(pty, "999", "1-9", MEGA))
    write_tiles(Path("tiles.toml"), [Place(3, f"port:{link}", 0, 0)])
    found = find_boards([], None)
    assert [(board.port.name, board.name, board.tile) for board in found.boards] == [(pty, f"port:{link}", 3)]
    assert pty not in [board.port.name for board in found.others]


def test_a_serial_number_that_is_no_text_disturbs_no_terminal(lab: list[ListPortInfo]) -> None:
    lab[:] = [usb("/dev/ttyACM0", "8\x1b[2J\n5", "1-1", MEGA)]
    [board] = find_boards([], None).boards
    assert board.name == "serial:8?[2J?5"
    write_tiles(Path("tiles.toml"), [Place(7, board.name, 0, 0)])
    assert [board.tile for board in find_boards([], None).boards] == [7]


def test_a_tile_that_calls_itself_otherwise_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    hello = HelloSentence(3, 9, 0, 21, 10, 100, 0, 0, 0, 255)
    tell_contradiction("p", 9, hello)
    tell_contradiction("p", None, hello)
    tell_contradiction("p", 7, None)
    assert capsys.readouterr().err == ""
    tell_contradiction("p", 7, hello)
    assert "tile 7 by the file of tiles, but it calls itself 9" in capsys.readouterr().err


def test_tiles_that_run_another_model_than_most_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    ours, other = (HelloSentence(3, 3, model, 21, 10, 100, 0, 0, 0, 255) for model in (0xABCD, 0x1234))
    tell_models({})
    tell_models({"a": ours, "b": ours})
    assert capsys.readouterr().err == ""
    tell_models({"a": other, "b": ours, "c": ours})
    assert capsys.readouterr().err.startswith("a: tile 3 runs model 1234, most run ABCD; ")
    tell_models({"a": other, "b": ours})
    told = capsys.readouterr().err
    assert "run different models, and ignore each other (tile 3 1234, tile 3 ABCD)" in told
    assert "--model DIR" in told, "neither of the two is the one to erase"


def test_lists_of_tiles() -> None:
    assert tile_numbers("3,7, 9-11") == {3, 7, 9, 10, 11}
    for wrong in ("", "x", "3-", "-3", "1,,2", "1-999", "9-3", "256", "\N{ARABIC-INDIC DIGIT THREE}"):
        with pytest.raises(UsageError, match="not a list of tiles"):
            tile_numbers(wrong)
