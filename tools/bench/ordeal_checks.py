"""What must hold while twenty tiles go through everything: findings, the links' counters, memory."""

import os
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from tilenca.base.sides import SIDES
from tilenca.emulator import Link
from tilenca.protocol.sentences import LinkSentence

End = tuple[int, int]
ON_ITS_WAY = 2  # frames: one on the cable, and one that is in a buffer
HEARD_LATE_S = 0.1  # a count is heard later than it was taken: the sentence takes time, and is read in slices
MARKS = (0.1, 0.5, 1.0)  # of a run, where its memory is looked at
GROWS_BY_MB, GROWS_BY = 8.0, 0.05  # at most, from the middle of a run to its end


@dataclass
class Findings:
    """What was done, and what should not have been.

    Attributes:
        deeds: how often, by kind.
        calms: how often all was mended and left alone.
        links: how often both ends of a link were compared meanwhile.
        frames: that these links received then.
        lost: frames that they lost then, although nothing harmed them.
        late: drawings that were not named by all tiles in time, and were later: the model's part.
        broken: what should never be, in words.
    """

    deeds: Counter[str] = field(default_factory=Counter)
    calms: int = 0
    links: int = 0
    frames: int = 0
    lost: int = 0
    late: list[str] = field(default_factory=list)
    broken: list[str] = field(default_factory=list)

    def summary(self) -> str:
        """The numbers."""
        return (
            f"{sum(self.deeds.values()):,} deeds, {self.calms} times left alone and looked at, "
            f"{self.lost} of {self.frames:,} frames lost then, {len(self.broken)} things broken, "
            f"{len(self.late)} drawings not named in time"
        )


class LinkBooks:
    """The counters of both ends of every link, as the tiles tell them while nothing is done to them."""

    def __init__(self) -> None:
        self._told: dict[End, list[tuple[float, LinkSentence]]] = {}

    def forget(self) -> None:
        """Something has been done: what was told before cannot be compared with what is told from now on."""
        self._told.clear()

    def hear(self, tile: int, time_s: float, sentence: LinkSentence) -> None:
        """Keeps what a tile says of one of its sides."""
        self._told.setdefault((tile, SIDES.index(sentence.side)), []).append((time_s, sentence))

    def check(self, links: list[Link], findings: Findings) -> list[str]:
        """Compares both directions of links; what does not add up, in words.

        A frame that was sent was received, or lost, or is on its way: so what a side counted of its
        neighbour's frames differs from what the neighbour counted by one number, however often both tell it.
        """
        wrong = []
        for one, side, other, other_side in links:
            for sender, receiver in (((one, side), (other, other_side)), ((other, other_side), (one, side))):
                sent, got = self._told.get(sender, []), self._told.get(receiver, [])
                if len(sent) < 2 or len(got) < 2:
                    continue
                first, last = got[0][1], got[-1][1]
                findings.links += 1
                findings.frames += last.received - first.received
                findings.lost += max(last.lost - first.lost, last.corrupt - first.corrupt)
                if not adds_up(sent, got):
                    words = f"{_name(receiver)} counts otherwise than {_name(sender)} sends"
                    wrong.append(words)
                if last.foreign != first.foreign:
                    wrong.append(f"{_name(receiver)} heard tiles with another model")
        return wrong


def adds_up(sent: list[tuple[float, LinkSentence]], got: list[tuple[float, LinkSentence]]) -> bool:
    """Whether what one end sent can be what the other received and lost; times are in seconds."""
    least, most = -float("inf"), float("inf")
    for time_s, told in got:
        counted = told.received + max(told.lost, told.corrupt)
        before = [count.sent for then_s, count in sent if then_s <= time_s - HEARD_LATE_S]
        after = [count.sent for then_s, count in sent if then_s >= time_s + HEARD_LATE_S]
        if after:  # no more than that was sent
            least = max(least, counted - after[0])
        if before:  # and so much at least, but for what is on its way
            most = min(most, counted - before[-1] + ON_ITS_WAY)
    return least <= most


def _name(end: End) -> str:
    return f"tile {end[0] + 1} {SIDES[end[1]]}"


def memory_mb(statm: Path = Path("/proc/self/statm")) -> float:
    """Memory that this process holds now, in MB."""
    return int(statm.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


class MemoryWatch:
    """The memory at some shares of a run.

    Attributes:
        seen: MB by share.
    """

    def __init__(self) -> None:
        self.seen: dict[float, float] = {}

    def look(self, share: float) -> bool:
        """Notes the memory if a mark has been passed since the last call; whether it was."""
        passed = [mark for mark in MARKS if mark <= share and mark not in self.seen]
        for mark in passed:
            self.seen[mark] = memory_mb()
        return bool(passed)

    def drift(self) -> str | None:
        """What is wrong with it, in words; None: it stays."""
        if not {MARKS[1], MARKS[2]} <= self.seen.keys():
            return None
        middle, end = self.seen[MARKS[1]], self.seen[MARKS[2]]
        if end - middle <= max(GROWS_BY_MB, GROWS_BY * middle):
            return None
        return f"memory grew from {middle:.0f} to {end:.0f} MB in the second half"

    def words(self) -> str:
        """As `41 MB at 10 %, 41 MB at 50 %`."""
        return ", ".join(f"{mb:.0f} MB at {100 * mark:.0f} %" for mark, mb in sorted(self.seen.items()))
