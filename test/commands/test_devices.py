"""Which ports are tiles, what they are called, and who holds them."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from serial.tools.list_ports_common import ListPortInfo

from tilenca.base.errors import NoDeviceError, TilencaError
from tilenca.cli import main
from tilenca.commands import monitor
from tilenca.fleet import lock
from tilenca.fleet.lock import PortBusyError, holders, port_lock
from tilenca.fleet.ports import find_ports, megas, natural_key


@pytest.fixture
def pty() -> Iterator[str]:
    master, slave = os.openpty()
    yield os.ttyname(slave)
    os.close(master)
    os.close(slave)


def usb(device: str, vid: int | None, pid: int | None, serial_number: str | None = None) -> ListPortInfo:
    info = ListPortInfo(device)
    info.vid, info.pid, info.serial_number = vid, pid, serial_number
    return info


def test_megas_are_known_by_their_usb_ids_and_come_in_natural_order() -> None:
    infos = [
        usb("/dev/ttyACM10", 0x2341, 0x0042, "855"),
        usb("/dev/ttyACM2", 0x2A03, 0x0010),
        usb("/dev/ttyUSB0", 0x1A86, 0x7523),
        usb("/dev/ttyS0", None, None),
        usb("/dev/ttyACM1", 0x2341, 0x0043),  # an Uno
    ]
    found = megas(infos)
    assert [port.name for port in found] == ["/dev/ttyACM2", "/dev/ttyACM10", "/dev/ttyUSB0"]
    assert [port.about for port in found] == [
        "Arduino.org Mega 2560",
        "Arduino Mega 2560 R3",
        "CH340 adapter, maybe a Mega 2560",
    ]
    assert found[1].serial_number == "855"


def test_natural_order_compares_numbers_as_numbers() -> None:
    assert sorted(["tile10", "tile9", "tile", "10", "9"], key=natural_key) == [
        "9",
        "10",
        "tile",
        "tile9",
        "tile10",
    ]


def test_devices_prints_one_document_in_stable_order(
    pty: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "tile2").symlink_to(pty)
    (tmp_path / "notes.txt").write_text("not a port")
    assert main(["devices", "--json", "--port", f"{tmp_path}/*"]) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    [device] = json.loads(captured.out)["devices"]
    assert device["port"] == f"{tmp_path}/tile2"
    assert [device[key] for key in ("vid", "pid", "serial_number", "tile")] == [None] * 4


def test_one_board_is_one_device_whatever_its_names(pty: str, tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / name).symlink_to(pty)
    [port] = find_ports([f"{tmp_path}/*", pty])
    assert port.name == f"{tmp_path}/a"


def test_a_named_port_that_is_missing_is_told_and_stops_no_other(
    pty: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    missing = tmp_path / "ttyACM9"
    assert main(["devices", "--json", "--port", pty, "--port", str(missing)]) == 0
    captured = capsys.readouterr()
    assert [device["port"] for device in json.loads(captured.out)["devices"]] == [pty]
    assert captured.err == f"{missing}: no such port\n"


@pytest.mark.parametrize("command", ["devices", "flash", "monitor"])
@pytest.mark.parametrize("pattern", ["ttyACM*", "ttyACM0"])
def test_no_device_exits_with_3_and_a_remedy(
    command: str,
    pattern: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(monitor, "PATIENCE_S", 0.0)
    assert main([command, "--port", str(tmp_path / pattern)]) == 3
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert "`tilenca devices` lists" in captured.err


def test_a_plain_file_is_no_port(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(NoDeviceError):
        find_ports([str(tmp_path / "file")])


@pytest.mark.parametrize("name", ["/dev/null", "/dev/zero"])
def test_a_device_with_nothing_behind_it_is_no_port(name: str) -> None:
    with pytest.raises(NoDeviceError):
        find_ports([name])


def test_a_lock_names_its_holder_and_ends_with_its_block(pty: str) -> None:
    holder = rf"^tilenca flash \(pid {os.getpid()}\)$"
    with port_lock(pty, "tilenca flash"), pytest.raises(PortBusyError, match=holder), port_lock(pty, "other"):
        pass
    with port_lock(pty, "other"):
        pass


def test_where_no_port_may_be_opened_nothing_is_learnt_and_flashing_is_not_advised(
    pty: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "tiles.toml"
    file.write_text("of somebody's own")
    with port_lock(pty, "tilenca flash"):
        assert main(["devices", "--learn", "--tiles", str(file), "--port", pty]) == 1
    first, last = capsys.readouterr().err.splitlines()
    assert first == f"{pty}: busy: tilenca flash (pid {os.getpid()}) has it open; left out"
    assert last.endswith(": no tile answers")
    assert file.read_text() == "of somebody's own"


def test_a_lock_holds_for_users_with_another_folder_for_temporary_files(
    pty: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with port_lock(pty, "us"):
        monkeypatch.setenv("TMPDIR", str(tmp_path))
        with pytest.raises(PortBusyError, match="us"), port_lock(pty, "other"):
            pass


def test_a_child_keeps_the_lock_it_was_given_until_it_ends(pty: str) -> None:
    with port_lock(pty, "tilenca flash") as descriptor:
        child = subprocess.Popen(
            [sys.executable, "-c", "input()"], stdin=subprocess.PIPE, pass_fds=[descriptor]
        )
    try:
        with pytest.raises(PortBusyError), port_lock(pty, "other"):
            pass
    finally:
        child.communicate(b"\n", timeout=60)
    with port_lock(pty, "other"):
        pass


def test_a_program_that_has_the_port_open_is_named(pty: str) -> None:
    program = f"open({pty!r}).fileno(); f = open({pty!r}); print(flush=True); input()"
    with subprocess.Popen(
        [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as child:
        assert child.stdout is not None
        child.stdout.readline()
        held = holders([pty])
        child.communicate(b"\n", timeout=60)
    assert held[pty].endswith(f"(pid {child.pid})")
    assert holders([pty]) == {}, "neither this process nor a dead one holds it"


def test_a_lock_holds_even_where_there_is_no_room_for_a_name(pty: str) -> None:
    program = (
        "import resource, sys; from tilenca.fleet.lock import port_lock; "
        "resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)); lock = port_lock(sys.argv[1], 'us'); "
        "lock.__enter__(); print(flush=True); input()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", program, pty], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as child:
        assert child.stdout is not None
        child.stdout.readline()
        with pytest.raises(PortBusyError, match=r"^another tilenca command$"), port_lock(pty, "other"):
            pass
        child.communicate(b"\n", timeout=60)


def test_locks_that_cannot_be_kept_are_told(
    pty: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "tilenca-locks").write_text("a file of somebody's")
    monkeypatch.setattr(lock, "FOLDER", tmp_path / "tilenca-locks")
    with pytest.raises(TilencaError, match=r"tilenca-locks.*Not a directory.*remove"), port_lock(pty, "us"):
        pass
