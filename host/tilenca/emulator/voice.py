"""What one tile of an experiment has said so far, and since when."""

from dataclasses import dataclass, field

from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.sentences import LinkSentence, TileSentence


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
