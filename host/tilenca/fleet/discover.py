"""`tilenca devices --learn`: finds out which tile is behind which port and where it lies."""

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

USER = "tilenca devices --learn"
# Every tile tells of its four sides, one after another, one a period: five periods, and no less than this.
LISTEN_S = 12.0
# A tile knows a neighbour's new id from its next frame, which comes within a period; and tells it after that.
SETTLE_S = 0.5
TICK_S = 0.1


@dataclass(frozen=True)
class Learnt:
    """What was found: the places, what each port's tile answered, and how many tiles have no place."""

    places: list[Place]
    answers: dict[str, Answer]
    left_out: int


def learn(boards: Sequence[Board], blink: bool, assign: bool, before: Sequence[Place] = ()) -> Learnt:
    """Asks the tiles who they are and who is on which side; where that is not enough, the person.

    Args:
        boards: the boards.
        blink: let each tile blink and ask the person for its place, whatever tiles say.
        assign: give tiles without an id of their own a free one.
        before: what is known so far, by the boards' names now: of boards that do not answer, neither ids nor
            places are free.

    Raises:
        TilencaError: tiles have no id of their own, or places cannot be found out.
    """
    names = [board.port.name for board in boards]
    fleet = Fleet()
    with PortReader(names, user=USER) as reader:
        answers = ask(reader, names, hear=fleet.take)
        for name, answer in answers.items():
            if answer.hello is None:
                warn(f"{name}: {answer.problem}; left out")
        said = {name: answer.hello for name, answer in answers.items() if answer.hello}
        tell_models(said)
        here = {board.name for board in boards if board.port.name in said}
        away = [place for place in before if place.board not in here]
        tiles = _ids(reader, {name: hello.tile for name, hello in said.items()}, assign, away)
        if not tiles:
            remedy = (
                "; flash them first: tilenca flash" if any(map(_lacks_firmware, answers.values())) else ""
            )
            raise TilencaError(f"no tile answers{remedy}")
        renamed = any(tile != said[name].tile for name, tile in tiles.items())
        slowest_s = max(said[name].period_ms for name in tiles) / 1000
        _listen(
            reader,
            fleet,
            set(tiles),
            SETTLE_S + 2 * slowest_s if renamed else 0.0,
            max(LISTEN_S, 5 * slowest_s),
        )
        cells = _asked(reader, tiles, away) if blink else _heard(tiles, fleet)
    by_port = {board.port.name: board.name for board in boards}
    places = [Place(tile, by_port[name], *cells[tile]) for name, tile in tiles.items() if tile in cells]
    return Learnt(places, answers, len(boards) - len(places))


def _lacks_firmware(answer: Answer) -> bool:
    """Whether flashing would help: the port could be opened, and nothing that is ours spoke."""
    return answer.problem in (SILENT, BOARD_TEST) or answer.problem.startswith("speaks protocol")


def _ids(reader: PortReader, said: dict[str, int], assign: bool, away: Sequence[Place]) -> dict[str, int]:
    """Each port's tile id; those that have none of their own get one, if they may."""
    tiles: dict[str, int] = {}
    lacking = []
    for name, tile in said.items():
        if tile == 0 or tile in tiles.values():
            lacking.append(name)
        else:
            tiles[name] = tile
    if not lacking:
        return tiles
    if not assign:
        them = ", ".join(
            f"{name} ({f'{said[name]}, as another' if said[name] else 'none'})" for name in lacking
        )
        raise TilencaError(
            f"tiles without an id of their own: {them}; add --assign to give them free ones, or set each "
            "with `tilenca set id N --port PORT`"
        )
    used = {*tiles.values(), *(place.tile for place in away)}
    free = (tile for tile in range(1, MAX_TILE_ID + 1) if tile not in used)
    fresh = dict(zip(lacking, free, strict=False))
    orders = {name: set_command("id", tile) for name, tile in fresh.items()}
    for name, reply in command_all(reader, orders, "SET").items():
        if reply.problem:
            warn(f"{name}: {reply.problem}; left out")
        else:
            tiles[name] = fresh[name]
            warn(f"{name}: its tile is {fresh[name]} now")
    return {name: tiles[name] for name in said if name in tiles}


def _listen(reader: PortReader, fleet: Fleet, names: set[str], settle_s: float, patience_s: float) -> None:
    """Hears every tile tell of all its sides, as it is in `settle_s`: what is said before is forgotten."""
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


def _heard(tiles: Mapping[str, int], fleet: Fleet) -> dict[int, tuple[int, int]]:
    """Finds each tile's place from what they say of their neighbours."""
    alone: dict[int, dict[str, tuple[int, str]]] = {tile: {} for tile in tiles.values()}
    found = arrange(alone | neighbours(fleet))
    if found.conflicts:
        raise TilencaError(
            f"what tiles say of their neighbours does not fit together: {found.conflicts[0]}; "
            "check the plugs, or add --blink to say yourself where each lies"
        )
    cells = {tile: cell for tile, cell in found.cells.items() if tile in tiles.values()}
    if len(found.groups) > 1:
        groups = "; ".join(" ".join(map(str, group)) for group in found.groups)
        warn(
            f"{len(found.groups)} groups of tiles do not touch ({groups}): how they lie to each other is a "
            "guess; edit the file, or add --blink to say where each lies"
        )
    return cells


def _asked(reader: PortReader, tiles: Mapping[str, int], away: Sequence[Place]) -> dict[int, tuple[int, int]]:
    """Lets one tile after another blink, and takes its place from standard input."""
    taken = {(place.row, place.col) for place in away if place.tile not in tiles.values()}
    cells: dict[int, tuple[int, int]] = {}
    for name, tile in tiles.items():
        reply = command_all(reader, {name: blink_command(MAX_BLINK_S)}, "BLINK")[name]
        if reply.problem:
            warn(f"{name}: {reply.problem}; left out")
            continue
        place = _typed(tile, name, taken | set(cells.values()))
        command_all(reader, {name: blink_command(0)}, "BLINK")
        if place:
            cells[tile] = place
    return cells


def _typed(tile: int, name: str, taken: Set[tuple[int, int]]) -> tuple[int, int] | None:
    """A place from standard input; None if there is none."""
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
