"""Boards on USB as pyserial finds them: its own code, on a /sys as the kernel lays it out."""

import glob
import os
from pathlib import Path
from types import SimpleNamespace

import pytest
from serial.tools import list_ports_linux
from serial.tools.list_ports_common import ListPortInfo

from tilenca.base.errors import NoDeviceError, TilencaError
from tilenca.fleet import ports
from tilenca.fleet.boards import find_boards
from tilenca.fleet.ports import find_ports, megas, natural_key

CDC, USB_SERIAL = "usb", "usb-serial"


class Computer:
    """A /sys and a /dev below a folder."""

    def __init__(self, root: Path) -> None:
        self.root = root
        (root / "dev").mkdir()

    def _write(self, folder: Path, **files: object) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in files.items():
            (folder / name).write_text(f"{content}\n")

    def plug(self, name: str, socket: str, ids: tuple[int, int], driver: str, **said: object) -> None:
        """A board at a socket, which the kernel calls /dev/`name`."""
        board = self.root / "sys/devices/pci0000:00/usb1" / socket
        vendor, product = (f"{number:04x}" for number in ids)
        said = {"bNumInterfaces": " 2" if driver == CDC else " 1", **said}
        self._write(board, idVendor=vendor, idProduct=product, **said)
        interface = board / f"{socket}:1.0"
        # A CDC port is its interface; a serial chip's port lies below it, on a bus of its own.
        self.port(name, interface if driver == CDC else interface / name, driver)

    def port(self, name: str, device: Path, bus: str) -> None:
        self._write(device)
        (device / "subsystem").symlink_to(self.root / "sys/bus" / bus)
        known = self.root / "sys/class/tty" / name
        known.mkdir(parents=True)
        (known / "device").symlink_to(device)
        (self.root / "dev" / name).touch()


@pytest.fixture
def computer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Computer:
    def here(path: str) -> str:
        return f"{tmp_path}{path}" if path.startswith(("/sys", "/dev")) else path

    look = SimpleNamespace(
        exists=lambda path: os.path.exists(here(path)),  # noqa: PTH110
        islink=lambda path: os.path.islink(here(path)),  # noqa: PTH114
        realpath=lambda path: os.path.realpath(here(path)),
        basename=os.path.basename,
        dirname=os.path.dirname,
        join=os.path.join,
    )
    monkeypatch.setattr(list_ports_linux, "os", SimpleNamespace(path=look))
    listed = SimpleNamespace(
        glob=lambda pattern: [path.removeprefix(str(tmp_path)) for path in glob.glob(here(pattern))]  # noqa: PTH207
    )
    monkeypatch.setattr(list_ports_linux, "glob", listed)
    monkeypatch.setattr(ports, "comports", list_ports_linux.comports)
    monkeypatch.chdir(tmp_path)
    computer = Computer(tmp_path)
    computer.port("ttyS0", tmp_path / "sys/devices/platform/serial8250", "platform")
    return computer


def test_boards_are_named_by_what_pyserial_reads_of_them(computer: Computer) -> None:
    computer.plug("ttyACM0", "1-2.3", (0x2341, 0x0042), CDC, serial="955303436", product="Mega 2560 R3")
    computer.plug("ttyACM1", "1-2.4", (0x2A03, 0x0042), CDC)
    computer.plug("ttyUSB0", "1-2.1", (0x1A86, 0x7523), USB_SERIAL, product="USB2.0-Serial")
    computer.plug("ttyUSB1", "1-3", (0x0403, 0x6001), USB_SERIAL, serial="A50285BI")
    computer.plug("ttyUSB2", "1-4", (0x0403, 0x6001), USB_SERIAL, serial="A50285BI")
    computer.plug("ttyUSB3", "1-5", (0x10C4, 0xEA60), USB_SERIAL, serial="0001")  # not a Mega's chip
    assert [(board.port.name, board.name) for board in find_boards([], None).boards] == [
        ("/dev/ttyACM0", "serial:955303436"),
        ("/dev/ttyACM1", "location:1-2.4:1.0"),
        ("/dev/ttyUSB0", "location:1-2.1"),
        ("/dev/ttyUSB1", "location:1-3"),
        ("/dev/ttyUSB2", "location:1-4"),
    ]
    assert [port.about for port in ports.find_ports()][1:3] == [
        "Arduino.org Mega 2560 R3",
        "CH340 adapter, maybe a Mega 2560",
    ]


def test_udevs_links_lead_to_the_board(computer: Computer, monkeypatch: pytest.MonkeyPatch) -> None:
    computer.plug("ttyACM0", "1-2.3", (0x2341, 0x0042), CDC, serial="955")
    by_id, by_path = computer.root / "usb-Arduino_955-if00", computer.root / "pci-0000:00-usb-0:2.3:1.0"
    for link in (by_id, by_path):
        link.symlink_to("/dev/ttyACM0")
    monkeypatch.setattr(ports, "is_device", os.path.lexists)  # there is no such device here
    for named in ([by_id, by_path], [by_path, by_id], [by_path]):
        [board] = find_boards([str(link) for link in named], None).boards
        assert board.port.name == str(named[0]), "of two names of one port the first counts"
        assert (board.name, board.port.location) == ("serial:955", "1-2.3:1.0")
        assert board.port.vid == 0x2341


def test_a_board_that_is_pulled_while_it_is_looked_at_stops_nobody(
    computer: Computer, monkeypatch: pytest.MonkeyPatch
) -> None:
    computer.plug("ttyACM0", "1-2.3", (0x2341, 0x0042), CDC, serial="955")
    computer.plug("ttyACM1", "1-2.4", (0x2341, 0x0042), CDC, serial="956")
    (computer.root / "sys/devices/pci0000:00/usb1/1-2.4/idVendor").unlink()

    def looked_at_too_early() -> list[ListPortInfo]:
        try:
            found: list[ListPortInfo] = list_ports_linux.comports()
            return found
        except TypeError:
            (computer.root / "dev/ttyACM1").unlink(missing_ok=True)
            raise

    monkeypatch.setattr(ports, "LOOK_AGAIN_S", 0.0)
    with pytest.raises(TilencaError, match="plug it in again"):
        ports.find_ports()
    monkeypatch.setattr(ports, "comports", looked_at_too_early)
    assert [board.name for board in find_boards([], None).boards] == ["serial:955"]


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


def test_one_board_is_one_device_whatever_its_names(pty: str, tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / name).symlink_to(pty)
    [port] = find_ports([f"{tmp_path}/*", pty])
    assert port.name == f"{tmp_path}/a"


def test_a_plain_file_is_no_port(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(NoDeviceError):
        find_ports([str(tmp_path / "file")])


@pytest.mark.parametrize("name", ["/dev/null", "/dev/zero"])
def test_a_device_with_nothing_behind_it_is_no_port(name: str) -> None:
    with pytest.raises(NoDeviceError):
        find_ports([name])
