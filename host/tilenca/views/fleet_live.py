"""The monitor's live picture: a line about all tiles, the tiles in their places, the log."""

import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import PurePath
from textwrap import wrap

from rich.console import Console, ConsoleOptions, OverflowMethod, RenderResult
from rich.live import Live
from rich.segment import Segment
from rich.text import Text

from tilenca.fleet.events import News, Reporter, clock_text, news_line
from tilenca.fleet.grid import Cell, Grid, Position
from tilenca.fleet.state import Event, Fleet
from tilenca.views.fleet_grid import draw_fitting
from tilenca.views.fleet_table import live_table
from tilenca.views.tiles import shown_by

REDRAW_S = 0.25
LOG_LINES = 200
LEAST_LOG = 4
RATE_S = 2.0
LOG_INDENT = 13  # of the second line of a piece of news, below what comes after the time
MOST_NAMED = 4


class LiveView:
    """Shows the fleet on a terminal; enter `live` while it does."""

    def __init__(self, fleet: Fleet, grid: Grid, console: Console, table: bool, about: str = "") -> None:
        """Draws the grid, or with `table` one line per port; `about` names the recording.

        `footer` may be set to a function that gives the line below.
        """
        self._fleet, self._grid, self._table, self._about = fleet, grid, table, about
        self._console = console
        self._overflow: OverflowMethod = "crop" if console.options.ascii_only else "ellipsis"
        self.footer: Callable[[], str] = str
        self._reporter = Reporter(fleet, grid)
        self._log: deque[News] = deque(maxlen=LOG_LINES)
        self._counted: deque[tuple[float, int]] = deque(maxlen=2 + round(RATE_S / REDRAW_S))
        self._now_s = self._shown_s = 0.0
        self.live = Live(console=console, auto_refresh=False, get_renderable=lambda: _Screen(self))

    def show(self, now_s: float, events: Sequence[Event]) -> None:
        """Takes new events; draws at intervals, and at once after a pause."""
        self._now_s = now_s
        for event in events:
            self._log.extend(self._reporter.take(event))
        if time.monotonic() - self._shown_s >= REDRAW_S:
            self._shown_s = time.monotonic()
            self.live.refresh()

    def begin_again(self) -> None:
        """Forgets everything shown: the recording starts again."""
        self._fleet.tiles.clear()
        self._reporter = Reporter(self._fleet, self._grid)
        self._log.clear()
        self._counted.clear()

    def lines(self, width: int, height: int) -> list[Text]:
        """The whole picture, no wider and no higher than that."""
        grid = self._grid.cells(self._fleet, self._now_s)
        footer = [Text(line, style="dim") for line in wrap(self.footer(), width)][: max(height - 1, 0)]
        height -= len(footer)
        body = self._body(grid, width, height - 1 - LEAST_LOG)
        room = max(height - len(body) - 2, 0)
        log = (
            [line for news in list(self._log)[-room:] for line in self._log_lines(news, width)][-room:]
            if room
            else []
        )
        lines = [self._head(grid), *body, *log][: max(height, 0)] + footer
        for line in lines:
            line.truncate(width, overflow=self._overflow)
        return lines

    def _body(self, grid: dict[Position, Cell], width: int, height: int) -> list[Text]:
        if not self._table:
            picture = draw_fitting(grid, width, height, self._console.options.ascii_only)
            if picture is not None:
                return picture
        options = self._console.options.update(width=width, height=None)
        rendered = self._console.render_lines(
            live_table(self._fleet, self._now_s, width, self._overflow), options, pad=False
        )
        return [Text.assemble(*((part.text, part.style or "") for part in line)) for line in rendered][
            :height
        ]

    def _head(self, grid: dict[Position, Cell]) -> Text:
        cells = grid.values()
        shown = Counter(cell.label for cell in cells if cell.label is not None and not cell.trouble)
        views = self._fleet.tiles.values()
        self._counted.append((time.monotonic(), sum(view.sentences for view in views)))
        (first_s, first), (last_s, last) = self._counted[0], self._counted[-1]
        parts = [
            f"{len(cells)} tiles",
            shown_by((label or "nothing", count) for label, count in shown.most_common()),
            *_troubles(cells),
            f"{(last - first) / (last_s - first_s):.0f} sentences/s" if last_s > first_s else "",
            _counted(sum(view.damaged for view in views), "damaged line"),
            _counted(sum(view.total("corrupt") or 0 for view in views), "corrupt frame"),
            self._about or clock_text(self._now_s)[:-4],
        ]
        return Text("  ".join(filter(None, parts)), style="bold")

    def _log_lines(self, news: News, width: int) -> list[Text]:
        """One piece of news, in as many lines as it takes: a remedy stands at its end."""
        # The folder of a port tells nothing, and takes the room of the rest on a narrow terminal.
        told = news_line(news, PurePath(news.port).name)
        indent = " " * min(LOG_INDENT, width // 3)
        style = "yellow" if news.bad else ""
        return [Text(line, style) for line in wrap(told, max(width, 1), subsequent_indent=indent)]


def _counted(count: int, what: str) -> str:
    """So many of them; nothing where there are none."""
    return f"{count:,} {what}{'s' * (count != 1)}" if count else ""


def _troubles(cells: Iterable[Cell]) -> Iterator[str]:
    """Who cannot be heard: by name where they are few."""
    by_trouble: dict[str, list[Cell]] = {}
    for cell in cells:
        if cell.trouble:
            by_trouble.setdefault(cell.trouble, []).append(cell)
    for trouble, those in by_trouble.items():
        names = [str(cell.tile) for cell in those if cell.tile is not None]
        named = len(names) == len(those) <= MOST_NAMED
        yield f"{len(those)} {trouble}" + (f" (tile {', '.join(names)})" if named else "")


class _Screen:
    """The picture for Live: as much as fits the terminal's current size."""

    def __init__(self, view: LiveView) -> None:
        self._view = view

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        width, height = console.size
        for line in self._view.lines(width, height - 1):
            yield from line.render(console)
            yield Segment.line()
