"""Boards behind ports: each has a name that survives replugging and that `tiles.toml` uses."""

import os
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from tilenca.base.errors import NoDeviceError, UsageError
from tilenca.base.stdio import warn
from tilenca.fleet.ports import (
    Port,
    describe,
    find_ports,
    is_device,
    is_mega,
    natural_key,
    nature,
    serial_ports,
)
from tilenca.fleet.tiles_file import DEFAULT, MAX_TILE_ID, Place, read_tiles, tile_count
from tilenca.protocol.sentences import HelloSentence

_SPAN = re.compile(r"([0-9]{1,3})(?:-([0-9]{1,3}))?")


@dataclass(frozen=True)
class Board:
    """A port, the name of the board behind it (as in `tiles.toml`), and its place if the file has one."""

    port: Port
    name: str
    place: Place | None = None

    @property
    def tile(self) -> int | None:
        """The tile's id in `tiles.toml`."""
        return self.place.tile if self.place else None


@dataclass(frozen=True)
class Found:
    """The fleet.

    Attributes:
        boards: the connected ones, in the order of their ports.
        missing: the others that `tiles.toml` lists.
        others: boards on USB that it does not list.
    """

    boards: list[Board]
    missing: list[Place] = field(default_factory=list)
    others: list[Board] = field(default_factory=list)

    def tell_others(self) -> None:
        """Warns of the boards that are left out."""
        if self.others:
            names = ", ".join(board.port.name for board in self.others)
            warn(f"left alone, since the file of tiles does not list them: {names}; name them with --port")


def board_name(port: Port, shared: Iterable[str]) -> str:
    """A name that no other board has; `shared` are the serial numbers that several boards have."""
    if port.serial_number and port.serial_number not in set(shared):
        return f"serial:{port.serial_number}"
    if port.location:
        return f"location:{port.location}"
    return f"port:{Path(port.name).parent.resolve() / Path(port.name).name}"


def shared_serials(ports: Iterable[Port]) -> set[str]:
    """Serial numbers that more than one of the ports has."""
    counted = Counter(port.serial_number for port in ports if port.serial_number)
    return {number for number, times in counted.items() if times > 1}


def is_board(port: Port, name: str, shared: Iterable[str] = ()) -> bool:
    """Whether a name means the board at this port; a serial number that several boards share never does."""
    kind, _, value = name.partition(":")
    if kind == "port":
        return os.path.realpath(value) == os.path.realpath(port.name)
    if kind == "location":
        return value == port.location
    return value == port.serial_number and value not in shared


def match(ports: Sequence[Port], places: Sequence[Place], on_usb: Sequence[Port]) -> list[Board]:
    """The boards behind the ports.

    Args:
        ports: those in use.
        places: the entries of `tiles.toml`.
        on_usb: every port on USB, in use or not, so that a board's name depends on no other choice.
    """
    shared = shared_serials(on_usb)
    boards = []
    for port in ports:
        mine = [place for place in places if is_board(port, place.board, shared)]
        name = mine[0].board if mine else board_name(port, shared)
        boards.append(Board(port, name, mine[0] if mine else None))
    return boards


def names_now(places: Sequence[Place], boards: Sequence[Board], on_usb: Sequence[Port]) -> list[Place]:
    """The places under the names that `boards` have now; of two names of one board the first counts."""
    shared = shared_serials(on_usb)
    found: dict[str, Place] = {}
    for place in places:
        mine = (board.name for board in boards if is_board(board.port, place.board, shared))
        name = next(mine, place.board)
        found.setdefault(name, replace(place, board=name))
    return list(found.values())


def load_places(path: Path | None) -> list[Place]:
    """The tiles of the file that `--tiles` names, else of the one in this folder, else none.

    Raises:
        UsageError: the file is wrong, or lists nothing.
    """
    if path is None and not DEFAULT.exists():
        return []
    if places := read_tiles(path or DEFAULT):
        return places
    raise UsageError(
        f"{path or DEFAULT}: lists no tile; write it with `tilenca devices --learn`, or remove it"
    )


def ports_on_usb() -> list[Port]:
    """Every port on USB, with any device."""
    return [describe(info) for info in serial_ports()]


def match_ports(patterns: Sequence[str]) -> list[Board]:
    """The boards behind the ports that `--port` names, else all on USB; NoDeviceError if none is there."""
    return match(find_ports(patterns), [], ports_on_usb())


def find_boards(patterns: Sequence[str], path: Path | None) -> Found:
    """The fleet: the ports of `--port`, else the boards of `tiles.toml`, else the Mega 2560s on USB.

    Args:
        patterns: of `--port`.
        path: of `--tiles`.

    Raises:
        NoDeviceError: none of the ports exists, and no file lists a tile.
        UsageError: the file is wrong.
    """
    places = load_places(path)
    on_usb = ports_on_usb()
    if patterns or not places:
        return Found(match(find_ports(patterns), places, on_usb))
    names = [_short(place.board.partition(":")[2]) for place in places if place.board.startswith("port:")]
    paths = {os.path.realpath(name): name for name in names if is_device(name)}
    devices = {device: Port(name, about=nature(device)) for device, name in paths.items()}
    # The file may list a board by its USB socket whose USB ids are unknown here.
    listed = [p for p in on_usb if is_mega(p) or any(is_board(p, place.board) for place in places)]
    devices |= {os.path.realpath(port.name): port for port in listed}
    boards = match(sorted(devices.values(), key=lambda port: natural_key(port.name)), places, on_usb)
    known_places = {board.place for board in boards}
    missing = [place for place in places if place not in known_places]
    others = [board for board in boards if board.place is None]
    return Found([board for board in boards if board.place is not None], missing, others)


def _short(name: str) -> str:
    """A path relative to this folder, if it is inside."""
    path = Path(name)
    return str(path.relative_to(Path.cwd())) if path.is_relative_to(Path.cwd()) else name


def find_fleet(patterns: Sequence[str], path: Path | None) -> Found:
    """As `find_boards`, but requires at least one board of the fleet.

    Raises:
        NoDeviceError: there is none.
        UsageError: the file is wrong.
    """
    found = find_boards(patterns, path)
    if not found.boards:
        raise none_connected(found, path)
    return found


def none_connected(found: Found, path: Path | None) -> NoDeviceError:
    """The error for a fleet of which no board is connected."""
    listed = tile_count(len(found.missing))
    return NoDeviceError(
        f"of the {listed} that {path or DEFAULT} lists, none is connected; connect it, or give --port"
    )


def tell_contradiction(port: str, listed: int | None, hello: HelloSentence | None) -> None:
    """Warns if a tile's own id differs from the one in the file of tiles."""
    if listed is not None and hello and hello.tile != listed:
        warn(
            f"{port}: tile {listed} by the file of tiles, but it calls itself {hello.tile}; "
            "`tilenca devices --learn` writes the file anew, `tilenca set id` renames the tile"
        )


ONE_MODEL = "give all the same one: tilenca flash --model DIR, or tilenca flash for the digits"


def tell_models(hellos: Mapping[str, HelloSentence]) -> None:
    """Warns of the tiles that run another model than most: their neighbours ignore them."""
    counted = Counter(hello.model_id for hello in hellos.values())
    most = max(counted, key=lambda model: counted[model], default=0)
    if list(counted.values()).count(counted[most]) > 1:
        each = ", ".join(f"tile {hello.tile} {hello.model_id:04X}" for hello in hellos.values())
        warn(f"the tiles run different models, and ignore each other ({each}); {ONE_MODEL}")
        return
    for port, hello in hellos.items():
        if hello.model_id != most:
            warn(
                f"{port}: tile {hello.tile} runs model {hello.model_id:04X}, most run {most:04X}; these "
                f"tiles ignore each other; flash it: tilenca flash --port {port}"
            )


def tile_numbers(text: str) -> set[int]:
    """The tile ids of a list like `3,7,9-12`.

    Raises:
        UsageError: it is not such a list.
    """
    numbers: set[int] = set()
    for part in text.split(","):
        match = _SPAN.fullmatch(part.strip())
        first, last = (int(match[1]), int(match[2] or match[1])) if match else (1, 0)
        if not first <= last <= MAX_TILE_ID:
            raise UsageError(f"'{text}' is not a list of tiles such as 3,7,9-12, from 0 to {MAX_TILE_ID}")
        numbers.update(range(first, last + 1))
    return numbers
