"""The tiles' places on the monitor's screen: tiles as cells of a grid. Pure: the fleet in, cells out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum

from tilenca.base.sides import OFFSETS, SIDES
from tilenca.fleet.boards import Found
from tilenca.fleet.layout import arrange
from tilenca.fleet.link_health import FAILING
from tilenca.fleet.state import Fleet, TileView
from tilenca.fleet.tiles_file import Place
from tilenca.shapes.glyphs import look_of

Position = tuple[int, int]

# A tile that said nothing for so long, and for two of its periods where we know them, may be in trouble.
QUIET_S = 3.0


class Mark(Enum):
    """How a side's link is."""

    NONE = "nobody is there"
    WELL = "frames arrive"
    FAILING = "many frames get lost"
    DEAD = "a tile is there and not heard"
    FOREIGN = "a tile with another model is there"


@dataclass(frozen=True)
class Laid:
    """Where a tile lies, by row and column, and its id where it is known."""

    place: Position
    tile: int | None = None


@dataclass(frozen=True)
class Cell:
    """One tile as it is drawn.

    Attributes:
        tile: its id, None while it is not known.
        label: what it shows; None while it has said nothing.
        colour: RGB duty of what it shows.
        good: share of the frames that arrived lately, of its worst side.
        age_s: since its last sentence.
        trouble: one word for a tile that is away or silent, else "".
        marks: each side's link.
        port: behind which it is; None while no port is known.
    """

    tile: int | None
    label: str | None = None
    colour: tuple[int, int, int] = (0, 0, 0)
    updates: int | None = None
    good: float | None = None
    age_s: float | None = None
    trouble: str = ""
    marks: Mapping[str, Mark] = field(default_factory=dict)
    port: str | None = None

    @property
    def unheard(self) -> list[str]:
        """The sides at which a tile lies that speaks, and is not heard."""
        return [side for side, mark in self.marks.items() if mark is Mark.DEAD]


def patience_s(view: TileView) -> float:
    """How long a tile may say nothing."""
    return max(QUIET_S, 2 * view.hello.period_ms / 1000 if view.hello else 0.0)


def trouble(view: TileView, now_s: float) -> str:
    """One word for a tile that cannot be heard; "" if it is well."""
    if not view.is_open:
        return "away"
    return "silent" if view.heard_s is None or now_s - view.heard_s > patience_s(view) else ""


class Grid:
    """Finds each port's place: recorded, in `tiles.toml`, by what tiles say or said of others, or a row."""

    def __init__(self, places: Sequence[Place] = (), given: bool = False) -> None:
        """Takes the places of the file, if any; a `given` one counts more than a recording."""
        self._given = given
        self._places = {place.tile: (place.row, place.col) for place in places}
        self._tiles: dict[str, int] = {}
        self._laid: dict[str, Laid | None] = {}
        self._heard: dict[int, dict[str, tuple[int, str]]] = {}
        self._known: dict[int, dict[str, tuple[int, str]]] = {}
        self._cells: dict[int, Position] = {}

    def know(self, found: Found) -> None:
        """Learns which tile of the file is behind which port now."""
        self._tiles |= {board.port.name: board.tile for board in found.boards if board.tile is not None}

    def known(self) -> dict[str, Laid]:
        """Where the tile behind each port lies, as the file says it."""
        return {
            port: Laid(self._places[tile], tile) for port, tile in self._tiles.items() if tile in self._places
        }

    def lay(self, port: str, laid: Laid | None) -> None:
        """Learns from a recording where the tile behind a port lies from now on; None: it was taken away."""
        if self._given:
            return
        if laid is not None:
            kept = {other: at for other, at in self._laid.items() if at is None or at.place != laid.place}
            self._laid = kept
        self._laid[port] = laid

    def tile_of(self, view: TileView) -> int | None:
        """Which tile is behind a port: as the file says, else as it says itself."""
        return self._tiles.get(view.port, view.tile_id or None)

    def cells(self, fleet: Fleet, now_s: float) -> dict[Position, Cell]:
        """The tiles by row and column."""
        laid = {port: at for port, at in self._laid.items() if at is not None}
        lie = {} if laid else dict(self._places) or self._arranged(fleet)
        grid: dict[Position, Cell] = {lie[tile]: Cell(tile, trouble="no port") for tile in lie}
        grid |= {at.place: Cell(at.tile, trouble="silent", port=port) for port, at in laid.items()}
        taken: set[Position] = set()
        below = max((row for row, _ in grid), default=-1) + 1
        rest = 0
        for view in self._views(fleet):
            tile = self.tile_of(view)
            place = laid[view.port].place if view.port in laid else lie.get(tile or 0)
            if place is None or place in taken:
                place, rest = (below, rest), rest + 1
            taken.add(place)
            grid[place] = _cell(view, tile, now_s)
        return {place: _marked(cell, place, grid, fleet) for place, cell in grid.items()}

    def _views(self, fleet: Fleet) -> list[TileView]:
        """All tiles; one that came back behind another port is no longer behind the old one."""
        there = [view for view in fleet.tiles.values() if self._laid.get(view.port, view) is not None]
        here = {self.tile_of(view) for view in there if view.is_open} - {None}
        return [view for view in there if view.is_open or self.tile_of(view) not in here]

    def _arranged(self, fleet: Fleet) -> dict[int, Position]:
        heard = neighbours(fleet)
        if heard != self._heard:
            self._heard = heard
            # A neighbour that is not heard any more still lies there, unless tiles say otherwise by now.
            self._known |= {tile: self._known.get(tile, {}) | sides for tile, sides in heard.items()}
            found = arrange(self._known)
            if found.conflicts:
                self._known = heard
                found = arrange(heard)
            self._cells = found.cells
        return self._cells


def neighbours(fleet: Fleet) -> dict[int, dict[str, tuple[int, str]]]:
    """Who is on which side of whom, as far as tiles have said it; for `arrange`."""
    heard: dict[int, dict[str, tuple[int, str]]] = {}
    for view in fleet.tiles.values():
        if view.tile_id and view.links:
            heard[view.tile_id] = {
                side: (link.neighbour, link.neighbour_side)
                for side, link in view.links.items()
                if link.neighbour and link.neighbour_side and _joined(view, side)
            }
    return heard


def _joined(view: TileView, side: str) -> bool:
    """Whether a neighbour is heard on that side now; who was there before is of no interest."""
    return view.tile is None or side in view.tile.links


def _cell(view: TileView, tile: int | None, now_s: float) -> Cell:
    state = view.tile
    shares = [health.good for health in view.health.values() if health.good is not None]
    marks = {side: _mark(view, side) for side in SIDES}
    return Cell(
        tile,
        state.label if state else None,
        _colour(view),
        state.updates if state else None,
        min(shares, default=None),
        None if view.heard_s is None else max(now_s - view.heard_s, 0.0),
        trouble(view, now_s),
        marks,
        view.port,
    )


def _colour(view: TileView) -> tuple[int, int, int]:
    """Of the label: a digit's own, else that of the class."""
    state = view.tile
    if state is None or state.class_index is None:
        return (0, 0, 0)
    return look_of(state.label, state.class_index).colour


def _mark(view: TileView, side: str) -> Mark:
    health = view.health.get(side)
    if view.tile is None or side not in view.tile.links:
        if not (view.tile and health):
            return Mark.NONE
        return Mark.FOREIGN if health.foreign else Mark.DEAD if health.garbled else Mark.NONE
    good = health.good if health else None
    return Mark.FAILING if good is not None and good < FAILING else Mark.WELL


def _marked(cell: Cell, place: Position, grid: Mapping[Position, Cell], fleet: Fleet) -> Cell:
    """The cell with links marked dead that should be there: the neighbour lies beside, and is not heard."""
    if not cell.marks or cell.trouble:
        return cell
    marks = dict(cell.marks)
    for side, (down, right) in zip(SIDES, OFFSETS, strict=True):
        beside = grid.get((place[0] + down, place[1] + right))
        speaks = beside is not None and beside.label is not None and not beside.trouble
        if marks[side] is Mark.NONE and speaks:
            marks[side] = Mark.DEAD
    return Cell(**{**vars(cell), "marks": marks})
