"""Steps that are done one after the other, on a terminal and elsewhere."""

import re
import threading
from collections.abc import Sequence

import pytest
from rich import progress
from rich.console import Console, RenderableType

from support.standing_clock import StandingClock
from support.terminal import stderr_on_terminal
from tilenca.training.progress import Progress
from tilenca.views import steps as module
from tilenca.views.progress import Bars
from tilenca.views.steps import LINE_EVERY_S, Step, Steps, show_steps, time_text

NAMES = ("check", "train", "measure")


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> StandingClock:
    """The clock that the view goes by."""
    owned = StandingClock()
    monkeypatch.setattr(module, "time", owned)
    return owned


def drawn(lines: Sequence[RenderableType]) -> str:
    console = Console(width=200, color_system=None)
    with console.capture() as captured:
        console.print(*lines, sep="\n")
    return captured.get()


def test_before_a_step_has_a_pace_it_takes_as_long_as_expected() -> None:
    step = Step("train", expected_s=100.0)
    assert step.left_s(5.0) == 100.0
    step.began_s = 5.0
    assert step.left_s(25.0) == 80.0
    assert step.done(25.0) == pytest.approx(0.2)
    assert step.left_s(305.0) == 30.0, "overdue: a little more is always to come"
    step.ended_s = 400.0
    assert step.left_s(500.0) == 0.0


def test_a_step_beyond_its_estimate_has_no_number_but_by_its_own_pace() -> None:
    step = Step("train", expected_s=100.0, began_s=0.0)
    assert [step.left_text(now_s) for now_s in (20.0, 85.0, 101.0)] == [
        "about 80 s left",
        "about 20 s left",
        "longer than estimated",
    ]
    step.share = 0.5
    assert step.left_text(120.0) == "about 2 min left"
    unknown = Step("check", began_s=0.0)
    assert (unknown.left_text(99.0), unknown.left_s(99.0), unknown.done(99.0)) == ("", 0.0, 0.0)


def test_a_training_is_told_before_its_first_iteration(capsys: pytest.CaptureFixture[str]) -> None:
    steps = Steps(NAMES, "train")
    steps.begin("train")
    with steps.training_views("train", "measure").training((1,), 200) as tell:
        assert "train: 0 of 200 iterations; preparing" in drawn(steps.below(ascii_only=True))
        tell(Progress(1, 100, 0.1, 0.5, None, (2, 9)))
        assert "100 of 200 iterations" in drawn(steps.below(ascii_only=True))
        assert "measuring, 2 of 9 rows measured" in drawn(steps.below(ascii_only=True))


def test_a_step_with_a_pace_goes_by_it_and_not_by_earlier_work() -> None:
    step = Step("train", expected_s=1000.0, began_s=0.0, share=0.6, first=0.5)
    assert step.left_s(10.0) == pytest.approx(40.0)
    assert step.done(10.0) == 0.6
    step.share = 0.51
    assert step.left_s(10.0) == pytest.approx(490.0), "a hundredth is too little to go by"


def test_without_a_terminal_there_is_a_line_for_beginning_and_end_and_one_a_minute(
    clock: StandingClock, capsys: pytest.CaptureFixture[str]
) -> None:
    steps = Steps(NAMES, "train")
    steps.begin("check")
    steps.expect("train", 400.0)
    steps.expect("measure", 30.0)
    assert steps.expected() == "train at most 7 min, measure about 30 s"
    steps.end("check", "2 drawings")
    steps.begin("train")
    for iteration in range(10):
        clock.seconds += LINE_EVERY_S / 4
        steps.move("train", f"{iteration} of 40", iteration / 40)
    steps.end("train", "all targets held")
    steps.begin("measure")
    clock.seconds += 2 * LINE_EVERY_S
    steps.tick()
    steps.end("measure", "12 of 12 targets held")
    steps.tick()
    assert capsys.readouterr().err.splitlines() == [
        "[1/3] check",
        "[1/3] check done in 0 s: 2 drawings",
        "[2/3] train; at most 8 min left, less if the targets hold early",
        "[2/3] train: 3 of 40; at most 13 min left, less if the targets hold early",
        "[2/3] train: 7 of 40; at most 10 min left, less if the targets hold early",
        "[2/3] train done in 2 min 30 s: all targets held",
        "[3/3] measure; about 30 s left",
        "[3/3] measure; about 20 s left",
        "[3/3] measure done in 2 min 0 s: 12 of 12 targets held",
    ]


def test_a_step_that_was_done_before_is_told_without_a_time(capsys: pytest.CaptureFixture[str]) -> None:
    steps = Steps(NAMES, "train")
    steps.end("train", "trained before")
    assert capsys.readouterr().err == "[2/3] train: trained before\n"


def test_on_a_terminal_the_steps_stand_together_with_the_curve_of_the_training(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with stderr_on_terminal(monkeypatch) as screen, show_steps(NAMES, "train") as steps:
        steps.expect("train", 300.0)
        steps.expect("measure", 20.0)
        steps.end("check", "2 drawings")
        steps.begin("train")
        views = steps.training_views("train", "measure")
        with views.training((1, 2), 200) as tell:
            tell(Progress(1, 100, 0.1, 0.5, (3, 8, 0.1)))
            tell(Progress(2, 50, 0.1, 1.0, None))
            for lines in (steps.above(), steps.below(ascii_only=False)):
                assert lines
        with views.measuring("mine/README.md", 9) as say:
            say("5x4: 0.998")
        steps.end("measure", "7 of 8 targets held")
    assert re.search(r"check +━+ 2 drawings", screen.text)
    assert re.search(r"measure ━+ about 20 s", screen.text)
    assert "At most 6 min left, less if the targets hold early" in screen.text
    assert re.search(r"train +━+ 100 iterations; 50 iterations", screen.text)
    assert re.search(r"measure ━+ 7 of 8 targets held", screen.text)
    assert capsys.readouterr() == ("", "")


def test_the_share_of_a_training_is_that_of_all_its_seeds(clock: StandingClock) -> None:
    steps = Steps(NAMES, "train")
    steps.expect("train", 1000.0)
    steps.begin("train")
    with steps.training_views("train", "measure").training((1, 2), 200) as tell:
        tell(Progress(1, 0, 0.1, 0.5, None))
        clock.seconds += 10.0
        tell(Progress(1, 100, 0.1, 0.5, None))
        assert steps.left() == "at most 30 s left, less if the targets hold early"


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.0, "10 s"), (41.0, "50 s"), (90.0, "2 min"), (300.0, "5 min"), (301.0, "6 min")]
)
def test_times_to_come_are_rough(seconds: float, text: str) -> None:
    assert time_text(seconds) == text


class SlowBars(Bars):
    """A clock's view of a step is not drawn before the step has ended, if nothing keeps it from ending."""

    def __init__(self) -> None:
        super().__init__(progress.Progress())
        self.ticking, self.ended = threading.Event(), threading.Event()
        self.notes: list[str] = []

    def move(self, name: str, done: float, note: str) -> None:
        """Waits for the end, for a while."""
        if threading.current_thread() is not threading.main_thread():
            self.ticking.set()
            self.ended.wait(0.3)
        super().move(name, done, note)
        self.notes.append(note)


def test_the_clock_does_not_draw_a_step_as_at_work_after_its_end() -> None:
    steps, bars = Steps(NAMES, "train"), SlowBars()
    for name in NAMES:
        bars.add(name, name)
    steps.bars = bars
    steps.begin("train")
    clock = threading.Thread(target=steps.tick)
    clock.start()
    assert bars.ticking.wait(30)
    steps.end("train", "40 iterations")
    bars.ended.set()
    clock.join(30)
    assert bars.notes[-1] == "40 iterations"
    steps.move("train", "39 of 40", 0.9)
    assert bars.notes[-1] == "40 iterations", "a late word of it"


def test_a_training_that_ended_early_says_why(capsys: pytest.CaptureFixture[str]) -> None:
    steps = Steps(NAMES, "train")
    steps.begin("train")
    with steps.training_views("train", "measure").training((1, 2), 200) as tell:
        tell(Progress(1, 100, 0.1, 1.0, (8, 8, 0.0)))
        tell(Progress(2, 50, 0.1, 0.5, (3, 8, 0.1)))
    assert capsys.readouterr().err.endswith(
        ": 100 iterations of 200, since all targets that it looks at on the way held; 50 iterations\n"
    )
