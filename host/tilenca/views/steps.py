"""How far a work of several steps is, and how long all of it will still take.

On a terminal the steps stand below each other, with a curve while a network is trained; elsewhere there is a
line when a step begins and ends, and one a minute. All of it goes to stderr.
"""

import math
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from rich.console import Console, RenderableType
from rich.padding import Padding
from rich.text import Text

from tilenca.base.stdio import warn
from tilenca.training.progress import Progress, Tell
from tilenca.views.curve import Curve
from tilenca.views.progress import Bars, show_bars
from tilenca.views.training import PREPARING, TrainingViews, agreement_curve, reached, row_text

LINE_EVERY_S = 60.0
TICK_S = 1.0
TRUSTED_S, TRUSTED_SHARE = 3.0, 0.02  # of a step have passed before its own pace says how long it takes
OVERDUE = 0.1  # of its time so far is added to a step that takes longer than expected
ROUGHLY_FROM_S = 90.0  # from here on minutes are close enough
BAR_WIDTH = 20
INDENT = 2


@dataclass
class Step:
    """One of several steps.

    Attributes:
        name: a verb.
        expected_s: how long it will take, as far as that is known before.
        note: how far it is, in words.
        share: of it that is done (0..1), as told; None: it does not tell.
        first: the share at which it began, which is more than 0 where it goes on with earlier work.
        began_s, ended_s: on the clock of the view; None: not yet.
    """

    name: str
    expected_s: float = 0.0
    note: str = ""
    share: float | None = None
    first: float = 0.0
    began_s: float | None = None
    ended_s: float | None = None

    def left_s(self, now_s: float) -> float:
        """How long it will still take: by its own pace, and before there is one as expected."""
        if self.ended_s is not None:
            return 0.0
        if self.began_s is None:
            return self.expected_s
        passed_s = now_s - self.began_s
        if self.share is not None and self._has_pace(now_s):
            return passed_s * (1 - self.share) / (self.share - self.first)
        if not self.expected_s:
            return 0.0  # nobody knows
        return max(self.expected_s * (1 - self.first) - passed_s, OVERDUE * passed_s)

    def left_text(self, now_s: float) -> str:
        """The same in words; nothing where nobody knows, and no number once it takes longer than expected."""
        if self.began_s is None or self.ended_s is not None:
            return ""
        if not self._has_pace(now_s):
            if not self.expected_s:
                return ""
            if now_s - self.began_s > self.expected_s * (1 - self.first):
                return "longer than estimated"
        return f"about {time_text(self.left_s(now_s))} left"

    def _has_pace(self, now_s: float) -> bool:
        """Whether enough of it is done to say from that how long the rest takes."""
        if self.share is None or self.began_s is None:
            return False
        return now_s - self.began_s > TRUSTED_S and self.share - self.first > TRUSTED_SHARE

    def done(self, now_s: float) -> float:
        """The share of it that is done; by the time where it does not tell."""
        if self.began_s is None or self.share is not None:
            return self.share or 0.0
        if not self.expected_s:
            return 0.0
        passed_s = now_s - self.began_s
        return passed_s / max(passed_s + self.left_s(now_s), 1e-9)


class Steps:
    """Steps that are done one after the other; any thread may tell how far one is."""

    def __init__(self, names: Sequence[str], at_most: str) -> None:
        """Steps of these names; while the step `at_most` lasts, it may end sooner than expected."""
        self._steps = {name: Step(name) for name in names}
        self._at_most = at_most
        self._now: Step | None = None
        self._said_s = time.monotonic()
        # Whoever draws asks `above` and `below` while this is held, so that those must not wait for it.
        self._lock = threading.RLock()
        self._curve: Curve | None = None
        self.bars: Bars | None = None  # where there is a terminal

    def expect(self, name: str, seconds: float) -> None:
        """How long a step will take."""
        self._steps[name].expected_s = seconds
        if self.bars is not None:
            self.bars.note(name, f"about {time_text(seconds)}")

    def expected(self) -> str:
        """How long each step that has not begun will take, in words; nothing where nobody knows."""
        return ", ".join(
            f"{name} {'at most' if name == self._at_most else 'about'} {time_text(step.expected_s)}"
            for name, step in self._steps.items()
            if step.expected_s and step.began_s is None
        )

    def begin(self, name: str) -> None:
        """The step begins."""
        step = self._steps[name]
        with self._lock:
            step.began_s = time.monotonic()
            self._now = step
            if self.bars is not None:
                self.bars.move(name, 0.0, "")
                self.bars.draw()
            else:
                left = self.left()
                self._say(f"{self._title(step)}{left and f'; {left}'}")

    def move(self, name: str, note: str, share: float | None = None) -> None:
        """How far the step is; `share`: of it that is done (0..1), None where nobody knows."""
        step = self._steps[name]
        with self._lock:
            if step is not self._now:
                return  # a late word of a step that has ended
            if share is not None and step.share is None:
                step.first = share
            step.note, step.share = note, share
            self.tick()

    def end(self, name: str, note: str) -> None:
        """The step is done, whether it had begun or not; `note`: its result."""
        step = self._steps[name]
        with self._lock:
            now_s = step.ended_s = time.monotonic()
            step.note, self._now, self._curve = note, None, None
            if self.bars is not None:
                self.bars.move(name, 1.0, note)
                self.bars.stop(name)
                self.bars.draw()
            else:
                took = "" if step.began_s is None else f" done in {_clock(now_s - step.began_s)}"
                self._say(f"{self._title(step)}{took}: {note}")

    def left(self) -> str:
        """How long all of it will still take, in words; nothing where nobody knows yet."""
        now_s = time.monotonic()
        if not any(step.expected_s for step in self._steps.values()):
            return ""
        text = time_text(sum(step.left_s(now_s) for step in self._steps.values()))
        least = self._steps[self._at_most]
        if least.ended_s is None and least.expected_s > 0:
            return f"at most {text} left, less if the targets hold early"
        return f"about {text} left"

    def tick(self) -> None:
        """Draws the step at work, or without a terminal says a line where a minute has passed."""
        with self._lock:
            step, now_s = self._now, time.monotonic()
            if step is None:
                return
            if self.bars is not None:
                self.bars.move(step.name, step.done(now_s), step.left_text(now_s))
            elif now_s - self._said_s >= LINE_EVERY_S:
                words = (self._title(step) + (f": {step.note}" if step.note else ""), self.left())
                self._say("; ".join(filter(None, words)))

    def above(self) -> Sequence[RenderableType]:
        """The line above the steps on a terminal."""
        left = "" if self._now is None else self.left()
        return (Text(left[0].upper() + left[1:], style="bold"),) if left else ()

    def below(self, ascii_only: bool) -> Sequence[RenderableType]:
        """What stands below the steps on a terminal: how far the one at work is, and its curve."""
        step, curve = self._now, self._curve
        lines: list[RenderableType] = []
        if step is not None and step.note:
            lines.append(Padding(Text(f"{step.name}: {step.note}"), (1, 0, 0, INDENT)))
        if curve is not None:
            lines += [Padding(line, (0, 0, 0, INDENT)) for line in curve.lines(ascii_only)]
        return lines

    def training_views(self, train: str, measure: str) -> TrainingViews:
        """The views of a training whose two steps are called so."""

        @contextmanager
        def training(seeds: Sequence[int], total: int) -> Iterator[Tell]:
            latest: dict[int, Progress] = {}
            self._curve = agreement_curve(total)
            self.move(train, f"0 of {total} iterations; {PREPARING}")

            def tell(news: Progress) -> None:
                latest[news.seed] = news
                if self._curve is not None:
                    self._curve.add(news.iteration, news.agreement)
                share = sum(one.iteration for one in latest.values()) / (total * len(seeds))
                words = [
                    f"{f'seed {seed}: ' if len(seeds) > 1 else ''}{reached(one, total)}"
                    for seed, one in sorted(latest.items())
                ]
                self.move(train, "; ".join(words), share)

            yield tell
            self.end(train, "; ".join(_ended(one, total) for one in latest.values()))

        @contextmanager
        def measuring(where: str, count: int) -> Iterator[Callable[[str], None]]:
            rows = 0
            self.begin(measure)
            self.move(measure, row_text(0, count))

            def tell(row: str) -> None:
                nonlocal rows
                rows += 1
                self.move(measure, f"{row_text(rows, count)}, all of them will be in {where}; {row}")

            yield tell

        return TrainingViews(training, measuring)

    def _title(self, step: Step) -> str:
        names = list(self._steps)
        return f"[{names.index(step.name) + 1}/{len(names)}] {step.name}"

    def _say(self, line: str) -> None:
        self._said_s = time.monotonic()
        warn(line)


def _ended(news: Progress, total: int) -> str:
    held, asked, _ = news.check or (0, 1, 0.0)
    early = (
        f" of {total:,}, since all targets that it looks at on the way held"
        if news.iteration < total and held == asked
        else ""
    )
    return f"{news.iteration:,} iterations{early}"


def time_text(seconds: float) -> str:
    """A time to come, as roughly as it is known."""
    if seconds < ROUGHLY_FROM_S:
        return f"{max(1, math.ceil(seconds / 10)) * 10} s"
    return f"{math.ceil(seconds / 60)} min"


def _clock(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 60 else f"{seconds // 60:.0f} min {seconds % 60:.0f} s"


@contextmanager
def show_steps(names: Sequence[str], at_most: str) -> Iterator[Steps]:
    """Shows steps while the block runs.

    Args:
        names: of the steps, in their order.
        at_most: the one that may end sooner than expected.
    """
    console = Console(stderr=True)
    steps = Steps(names, at_most)
    ended = threading.Event()

    def tick() -> None:
        while not ended.wait(TICK_S):
            steps.tick()

    clock = threading.Thread(target=tick, daemon=True)
    ascii_only = console.options.ascii_only
    with show_bars(console, BAR_WIDTH, above=steps.above, below=lambda: steps.below(ascii_only)) as bars:
        if console.is_terminal:
            steps.bars = bars
            for name in names:
                bars.add(name, name, begun=False)
        clock.start()
        try:
            yield steps
        finally:
            ended.set()
            clock.join()
