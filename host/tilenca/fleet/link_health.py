"""The recent quality of a link, so that a person sees trouble before the link fails. Pure."""

from collections import deque

from tilenca.protocol.sentences import LinkSentence

# Long enough to count some frames at a tile's slowest usual pace, short enough to notice a loose plug.
WINDOW_MS = 10_000
# A link is well from the first share of arrived frames on; below the second it is failing.
WELL, FAILING = 0.98, 0.9
# So many damaged frames in the window, and no whole one, come from a tile; noise makes few.
GARBLED = 10


class LinkHealth:
    """The reports of one side over the last WINDOW_MS of the tile's own time."""

    def __init__(self) -> None:
        self._reports: deque[LinkSentence] = deque()

    def take(self, report: LinkSentence) -> None:
        """Adds the next report."""
        last = self._reports[-1] if self._reports else None
        if last and (report.uptime_ms < last.uptime_ms or report.received < last.received):
            self._reports.clear()  # the tile has restarted and counts anew
        self._reports.append(report)
        # The one just before the window stays: from there the window's frames are counted.
        while len(self._reports) > 1 and report.uptime_ms - self._reports[1].uptime_ms >= WINDOW_MS:
            self._reports.popleft()

    @property
    def good(self) -> float | None:
        """Share (0..1) of the frames sent to us that arrived whole; None if there were none."""
        if not self._reports:
            return None
        first, last = self._reports[0], self._reports[-1]
        arrived = last.received - first.received
        # A damaged frame leaves a gap in the sequence like a missing one: `lost` counts both.
        expected = arrived + last.lost - first.lost
        return arrived / expected if expected > 0 else None

    @property
    def foreign(self) -> bool:
        """Whether frames of another model came."""
        return len(self._reports) > 1 and self._reports[-1].foreign > self._reports[0].foreign

    @property
    def garbled(self) -> bool:
        """Whether there is a tile of which no frame arrives whole, so that nobody knows which one."""
        if len(self._reports) < 2:
            return False
        first, last = self._reports[0], self._reports[-1]
        return last.received == first.received and last.corrupt - first.corrupt >= GARBLED
