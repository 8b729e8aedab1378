"""`tilenca devices`: the ports behind which tiles are.

Nothing is opened: opening its port resets a Mega. So which tile a board is stays unknown here (`tile` is
null); a tile says its id in its telemetry, see `tilenca monitor`.
"""

import argparse
import json
from typing import Any

from tilenca.arguments import add_port_argument
from tilenca.ports import Port, find_ports
from tilenca.streams import warn
from tilenca.tables import table


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add_port_argument(parser)
    parser.add_argument("--json", action="store_true", help="one JSON document on stdout")


def run(args: argparse.Namespace) -> int:
    """Prints the devices; see `tilenca devices --help`."""
    ports = find_ports(args.port)
    for port in ports:
        if not port.present:
            warn(f"{port.name}: {port.about}")
    present = [port for port in ports if port.present]
    if args.json:
        print(json.dumps({"devices": [as_json(port) for port in present]}, indent=2))
        return 0
    rows = [[port.name, _ids(port), port.serial_number or "-", port.about or "-"] for port in present]
    print(table(["PORT", "USB ID", "SERIAL NUMBER", "WHAT"], rows))
    return 0


def as_json(port: Port) -> dict[str, Any]:
    """One entry of the document: USB ids are four lower-case hex digits, as lsusb writes them, or null."""
    return {
        "port": port.name,
        "vid": None if port.vid is None else f"{port.vid:04x}",
        "pid": None if port.pid is None else f"{port.pid:04x}",
        "serial_number": port.serial_number,
        "tile": None,
        "about": port.about,
    }


def _ids(port: Port) -> str:
    return "-" if port.vid is None or port.pid is None else f"{port.vid:04x}:{port.pid:04x}"
