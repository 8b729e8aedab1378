"""What a film shows, picture by picture: of a simulated run, or of a recording of real or emulated tiles."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from tilenca.base.errors import TilencaError, UsageError
from tilenca.fleet.grid import Grid
from tilenca.fleet.recording import Choice, recorded_shapes
from tilenca.fleet.state import Event, Fleet, TileView
from tilenca.shapes.edits import Cell
from tilenca.shapes.glyphs import DARK_LOOK, Look, look_of, look_of_class
from tilenca.simulator.trace import NOTHING, Film
from tilenca.views.tiles import shown_by

STEP_S, LAST_S = 0.4, 2.5  # how long a picture of a simulated run stays, and the last one
LEAST_S, MOST_S = 0.12, 2.0  # the same of a recording
LOOK_S, MOST_LOOKS = 0.1, 3000
QUIET_S = 0.5  # after which a tile that says nothing is dark


@dataclass(frozen=True)
class Picture:
    """All tiles at one time.

    Attributes:
        caption: the time, in words.
        agreed: whether all tiles are right, or, where nobody knows what is right, show the same.
        looks: of the tile in each of the reel's cells; None: there is none now.
        seconds: how long it stays.
    """

    caption: str
    agreed: bool
    looks: tuple[Look | None, ...]
    seconds: float


@dataclass(frozen=True)
class Reel:
    """The pictures of a film.

    Attributes:
        title: what happens in it.
        about: where it comes from.
        cells: N, the places of the tiles, by row and column from 0.
        pictures: in the order of time.
        eventful: the numbers of the pictures in which something is new, in their order; the first is one.
        agreed_at: the number of the picture from which all tiles agree to the end; None: there is none.
    """

    title: str
    about: str
    cells: tuple[Cell, ...]
    pictures: tuple[Picture, ...]
    eventful: tuple[int, ...]
    agreed_at: int | None

    @property
    def size(self) -> tuple[int, int]:
        """Rows and columns."""
        return 1 + max(row for row, _ in self.cells), 1 + max(col for _, col in self.cells)


def of_run(film: Film) -> Reel:
    """The reel of a simulated run: a picture for each step."""
    pictures = [
        Picture(
            f"step {step}",
            bool(film.right[step]),
            tuple(
                _look(film.labels, int(shown)) if there else None
                for shown, there in zip(film.shown[step], film.there[step], strict=True)
            ),
            STEP_S,
        )
        for step in range(len(film.shown))
    ]
    pictures[-1] = _staying(pictures[-1])
    agreed = film.agreed_at
    verdict = (
        f"every tile right from step {agreed}" if agreed is not None else "not every tile right at the end"
    )
    eventful = tuple(int(step) for step in film.eventful)
    return Reel(f"{film.name}: {verdict}", film.about, film.cells, tuple(pictures), eventful, agreed)


def _look(labels: Sequence[str], shown: int) -> Look:
    return DARK_LOOK if shown == NOTHING else look_of_class(labels, shown)


def of_recording(path: Path) -> Reel:
    """The reel of a recording: a picture whenever a tile shows something else, falls silent or comes.

    Args:
        path: what `--record` wrote.

    Raises:
        UsageError: the file cannot be read, or is no recording.
        TilencaError: no tile says in it what it shows.
    """
    if len(shapes := recorded_shapes(path)) > 1:
        raise UsageError(
            f"{path}: has runs of {', '.join(shapes)}, one after the other; film the recording of one shape"
        )
    grid = Grid()
    choice = Choice(path, (), grid.lay)
    events = list(choice)
    choice.complain(0.0)
    views = [view for view in _played(events) if view.tile is not None]
    if not views:
        raise TilencaError(f"{path}: no tile says in it what it shows; record with --record for longer")
    places = _places(events, grid, {view.port for view in views})
    shown = list(_looks(events, tuple(places)))
    pictures = [
        Picture(f"{begins_s:.1f} s", _agree(looks), looks, min(max(ends_s - begins_s, LEAST_S), MOST_S))
        for (begins_s, looks), (ends_s, _) in zip(
            shown, [*shown[1:], (shown[-1][0] + LAST_S, ())], strict=True
        )
    ]
    split = [number for number, picture in enumerate(pictures) if not picture.agreed]
    agreed = split[-1] + 1 if split else 0
    agreed_at = agreed if agreed < len(pictures) else None
    return Reel(
        f"{len(places)} tiles: {_verdict(pictures, agreed_at)}",
        f"{path.name}, {events[-1].time_s - events[0].time_s:.1f} s recorded",
        tuple(places.values()),
        tuple(pictures),
        tuple(range(len(pictures))),
        agreed_at,
    )


def _staying(last: Picture) -> Picture:
    return Picture(last.caption, last.agreed, last.looks, LAST_S)


def _verdict(pictures: Sequence[Picture], agreed_at: int | None) -> str:
    last = Counter(look.label or "nothing" for look in pictures[-1].looks if look is not None)
    if agreed_at is None:
        return shown_by(last.most_common()) or "all silent"
    return f"all show {next(iter(last))} from {pictures[agreed_at].caption}"


def _agree(looks: Iterable[Look | None]) -> bool:
    labels = {look.label for look in looks if look is not None}
    return len(labels) == 1 and labels != {""}


def _played(events: Iterable[Event]) -> list[TileView]:
    fleet = Fleet()
    for event in events:
        fleet.take(event)
    return list(fleet.tiles.values())


def _places(events: Sequence[Event], grid: Grid, ports: set[str]) -> dict[str, Cell]:
    """The place of each port, as the recording or the tiles say in the end; rows and columns from 0.

    A tile whose place is recorded has one, even if it never says anything.
    """
    fleet = Fleet()
    for number, event in enumerate(events, start=1):
        fleet.take(event)
        if number % len(ports) == 0:
            grid.cells(fleet, event.time_s)  # it remembers neighbours that fall silent later
    cells = grid.cells(fleet, events[-1].time_s)
    lie = {
        cell.port: place
        for place, cell in cells.items()
        if cell.port is not None and (cell.port in ports or cell.port not in fleet.tiles)
    }
    if not lie:
        raise TilencaError("no tile lies on the board at the recording's end; there is nothing to draw")
    top, left = min(row for row, _ in lie.values()), min(col for _, col in lie.values())
    placed = {port: (row - top, col - left) for port, (row, col) in lie.items()}
    return dict(sorted(placed.items(), key=lambda one: one[1]))


def _looks(
    events: Sequence[Event], ports: tuple[str, ...]
) -> Iterable[tuple[float, tuple[Look | None, ...]]]:
    """What the tiles show, and since when, in seconds from the beginning; each unlike the one before."""
    first_s, last_s = events[0].time_s, events[-1].time_s
    every_s = max(LOOK_S, (last_s - first_s) / MOST_LOOKS)
    fleet = Fleet()
    before: tuple[Look | None, ...] | None = None
    due_s, looked = first_s, 0
    for event in [*events, None]:
        while event is None or event.time_s > due_s:
            looks = tuple(_seen(fleet.tiles.get(port), due_s) for port in ports)
            if looks != before:
                yield due_s - first_s, looks
                before = looks
            if event is None:
                return
            looked += 1
            due_s = first_s + looked * every_s
        fleet.take(event)


def _seen(view: TileView | None, now_s: float) -> Look:
    """What a tile shows; dark before it said so, and while it says nothing."""
    if view is None or view.tile is None or view.tile.class_index is None or view.heard_s is None:
        return DARK_LOOK
    patience_s = max(QUIET_S, 2 * view.hello.period_ms / 1000 if view.hello else 0.0)
    if not view.is_open or now_s - view.heard_s > patience_s:
        return DARK_LOOK
    return look_of(view.tile.label, view.tile.class_index)
