"""What one tile of an experiment has said so far, and since when."""

from dataclasses import dataclass, field

from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.sentences import LinkSentence, TileSentence

# An update's sentence follows the display within this time; the next update comes later.
TELLING_MS = 5.0
FRAME_COUNTERS = ("sent", "received", "corrupt", "lost")


@dataclass
class Voice:
    """The sentences of one tile so far.

    Attributes:
        started_s: when its clock of milliseconds was 0; None: it has not reported yet.
        first_update_s: when it reported its first update; None: it has not.
    """

    reader: LineReader = field(default_factory=LineReader)
    reports: list[TileSentence] = field(default_factory=list)
    links: dict[str, LinkSentence] = field(default_factory=dict)
    started_s: float | None = None
    first_update_s: float | None = None

    @property
    def updates(self) -> int:
        """The updates that it has reported."""
        return self.reports[-1].updates if self.reports else 0

    def updates_at(self, moment_s: float, rate: float) -> int:
        """The updates that it had done by then, with a clock of that rate."""
        started_s = moment_s if self.started_s is None else self.started_s
        uptime_ms = (moment_s - started_s) * 1000 * rate + TELLING_MS
        done = (report.updates for report in self.reports if report.uptime_ms <= uptime_ms)
        return max(done, default=0)

    def frames(self) -> dict[str, int]:
        """The sums over its sides of what the links report."""
        links = self.links.values()
        return {counter: sum(getattr(link, counter) for link in links) for counter in FRAME_COUNTERS}

    def restart(self) -> None:
        """Forgets the reports: the tile has been reset."""
        self.reports.clear()
        self.started_s = self.first_update_s = None

    def note(self, report: TileSentence, said_s: float, rate: float) -> None:
        """Adds a report that it began to send at that time, with a clock of that rate."""
        self.reports.append(report)
        if self.started_s is None:
            self.started_s = said_s - report.uptime_ms / 1000 / rate
        if self.first_update_s is None and report.updates > 0:
            self.first_update_s = said_s
