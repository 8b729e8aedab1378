"""`tilenca devices --learn`: finds the tile behind each port, and its place."""

import sys
import time
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass

from tilenca.base.errors import TilencaError
from tilenca.base.stdio import warn
from tilenca.fleet.boards import Board, tell_models
from tilenca.fleet.command import command_all
from tilenca.fleet.grid import neighbours
from tilenca.fleet.identify import SILENT, Answer, ask
from tilenca.fleet.layout import arrange
from tilenca.fleet.reader import PortReader
from tilenca.fleet.state import Fleet
from tilenca.fleet.tiles_file import FAR, MAX_TILE_ID, Place
from tilenca.protocol.board_test import BOARD_TEST
from tilenca.protocol.commands import blink_command, set_command
from tilenca.protocol.constants import MAX_BLINK_S
from tilenca.protocol.describe import whole_number
from tilenca.protocol.sentences import HelloSentence

USER = "tilenca devices --learn"
# A tile reports one of its four sides per period: wait for five periods, and no less than this.
LISTEN_S = 12.0
# A tile learns a neighbour's new id from its next frame, within a period, and reports it after that.
SETTLE_S = 0.5
TICK_S = 0.1


@dataclass(frozen=True)
class Learnt:
    """The places that were found, each port's answer, and how many tiles have no place."""

    places: list[Place]
    answers: dict[str, Answer]
    left_out: int


def learn(boards: Sequence[Board], blink: bool, assign: bool, before: Sequence[Place] = ()) -> Learnt:
    """Asks the tiles for their ids and their neighbours; where that is not enough, asks the person.

    Args:
        boards: the boards.
        blink: let each tile blink and ask the person for its place, even if its links tell it.
        assign: give tiles without an id of their own a free one.
        before: the places known so far, by the boards' names now. The ids and places of boards that do not
            answer are not free.

    Raises:
        TilencaError: tiles have no id of their own, or places cannot be found out.
    """
    names = [board.port.name for board in boards]
    fleet = Fleet()
    with PortReader(names, user=USER) as reader:
        answers = ask(reader, names, hear=fleet.take)
        hellos = _greetings(answers)
        here = {board.name for board in boards if board.port.name in hellos}
        away = [place for place in before if place.board not in here]
        tiles = _ids(reader, {name: hello.tile for name, hello in hellos.items()}, assign, away)
        if not tiles:
            remedy = (
                "; flash them first: tilenca flash" if any(map(_lacks_firmware, answers.values())) else ""
            )
            raise TilencaError(f"no tile answers{remedy}")
        _hear_links(reader, fleet, tiles, hellos)
        cells = _places_from_person(reader, tiles, away) if blink else _places_from_links(tiles, fleet)
    by_port = {board.port.name: board.name for board in boards}
    places = [Place(tile, by_port[name], *cells[tile]) for name, tile in tiles.items() if tile in cells]
    return Learnt(places, answers, len(boards) - len(places))


def _greetings(answers: Mapping[str, Answer]) -> dict[str, HelloSentence]:
    """The greetings of the tiles that answered; warns of the others."""
    for name, answer in answers.items():
        if answer.hello is None:
            warn(f"{name}: {answer.problem}; left out")
    hellos = {name: answer.hello for name, answer in answers.items() if answer.hello}
    tell_models(hellos)
    return hellos


def _lacks_firmware(answer: Answer) -> bool:
    """Whether flashing would help: the port could be opened, but no firmware of ours spoke."""
    return answer.problem in (SILENT, BOARD_TEST) or answer.problem.startswith("speaks protocol")


def _ids(reader: PortReader, ids: dict[str, int], assign: bool, away: Sequence[Place]) -> dict[str, int]:
    """Each port's tile id; tiles without one of their own get a free one, if `assign` allows it.

    Args:
        reader: of the ports.
        ids: the id that each port's tile has; 0 for none.
        assign: whether tiles may get ids.
        away: the places of tiles that do not answer; their ids are not free.
    """
    tiles: dict[str, int] = {}
    for name, tile in ids.items():
        if tile != 0 and tile not in tiles.values():
            tiles[name] = tile
    lacking = [name for name in ids if name not in tiles]
    if lacking and not assign:
        them = ", ".join(
            f"{name} ({f'{ids[name]}, as another' if ids[name] else 'none'})" for name in lacking
        )
        raise TilencaError(
            f"tiles without an id of their own: {them}; add --assign to give them free ones, or set each "
            "with `tilenca set id N --port PORT`"
        )
    used = {*tiles.values(), *(place.tile for place in away)}
    tiles |= _assign(reader, lacking, used)
    return {name: tiles[name] for name in ids if name in tiles}


def _assign(reader: PortReader, names: Sequence[str], used: Set[int]) -> dict[str, int]:
    """Gives tiles the smallest ids that are not used; returns those that were taken."""
    free = (tile for tile in range(1, MAX_TILE_ID + 1) if tile not in used)
    fresh = dict(zip(names, free, strict=False))
    orders = {name: set_command("id", tile) for name, tile in fresh.items()}
    taken = {}
    for name, reply in command_all(reader, orders, "SET").items() if orders else ():
        if reply.problem:
            warn(f"{name}: {reply.problem}; left out")
        else:
            taken[name] = fresh[name]
            warn(f"{name}: its tile is {fresh[name]} now")
    return taken


def _hear_links(
    reader: PortReader, fleet: Fleet, tiles: Mapping[str, int], hellos: Mapping[str, HelloSentence]
) -> None:
    """Waits until the fleet knows the neighbours of all tiles, by the ids that they have now."""
    renamed = any(tile != hellos[name].tile for name, tile in tiles.items())
    slowest_s = max(hellos[name].period_ms for name in tiles) / 1000
    settle_s = SETTLE_S + 2 * slowest_s if renamed else 0.0
    _listen(reader, fleet, set(tiles), settle_s, max(LISTEN_S, 5 * slowest_s))


def _listen(reader: PortReader, fleet: Fleet, names: set[str], settle_s: float, patience_s: float) -> None:
    """Waits until every tile has told of all its sides; drops what tiles say before `settle_s` is over."""
    settled_s = time.monotonic() + settle_s
    for view in fleet.tiles.values():
        view.links.clear()
    while (now_s := time.monotonic()) < settled_s + patience_s:
        for event in reader.poll(TICK_S):
            fleet.take(event)
        if now_s < settled_s:
            for view in fleet.tiles.values():
                view.links.clear()
        elif all(len(fleet.tiles[name].links) == 4 for name in names):
            return


def _places_from_links(tiles: Mapping[str, int], fleet: Fleet) -> dict[int, tuple[int, int]]:
    """Finds each tile's place from the neighbours that the tiles report."""
    alone: dict[int, dict[str, tuple[int, str]]] = {tile: {} for tile in tiles.values()}
    found = arrange(alone | neighbours(fleet))
    if found.conflicts:
        raise TilencaError(
            f"the neighbours that tiles report contradict each other: {found.conflicts[0]}; "
            "check the plugs, or add --blink to enter each tile's place yourself"
        )
    cells = {tile: cell for tile, cell in found.cells.items() if tile in tiles.values()}
    if len(found.groups) > 1:
        groups = "; ".join(" ".join(map(str, group)) for group in found.groups)
        warn(
            f"{len(found.groups)} groups of tiles do not touch ({groups}): their places relative to each "
            "other are a guess; edit the file, or add --blink to enter each tile's place"
        )
    return cells


def _places_from_person(
    reader: PortReader, tiles: Mapping[str, int], away: Sequence[Place]
) -> dict[int, tuple[int, int]]:
    """Lets one tile after another blink, and reads its place from standard input."""
    taken = {(place.row, place.col) for place in away if place.tile not in tiles.values()}
    cells: dict[int, tuple[int, int]] = {}
    for name, tile in tiles.items():
        reply = command_all(reader, {name: blink_command(MAX_BLINK_S)}, "BLINK")[name]
        if reply.problem:
            warn(f"{name}: {reply.problem}; left out")
            continue
        place = _read_place(tile, name, taken | set(cells.values()))
        command_all(reader, {name: blink_command(0)}, "BLINK")
        if place:
            cells[tile] = place
    return cells


def _read_place(tile: int, name: str, taken: Set[tuple[int, int]]) -> tuple[int, int] | None:
    """Reads a place from standard input; None for an empty line."""
    while True:
        warn(f"tile {tile} ({name}) blinks. Its row and column, such as 0 3 (nothing: leave it out)?")
        words = sys.stdin.readline().replace(",", " ").split()
        if not words:
            return None
        numbers = [whole_number(word) for word in words]
        match numbers:
            case [int() as row, int() as col] if abs(row) > FAR or abs(col) > FAR:
                warn(f"row and column are from -{FAR} to {FAR}")
            case [int() as row, int() as col] if (row, col) in taken:
                warn("another tile lies there")
            case [int() as row, int() as col]:
                return row, col
            case _:
                warn("two numbers, please")
