"""A recording is played at its pace, and as keys ask."""

from collections.abc import Sequence

import pytest

from tilenca.fleet.replay import FASTEST, SLOWEST, Player
from tilenca.fleet.state import Event, PortNews


class Clock:
    """Time that passes only by waiting, and a person who types certain keys at certain times."""

    def __init__(self, typed: Sequence[tuple[float, str]] = ()) -> None:
        self.now_s = 100.0
        self.typed = list(typed)

    def __call__(self) -> float:
        return self.now_s

    def wait(self, seconds: float) -> list[str]:
        self.now_s += seconds
        keys = [key for at_s, key in self.typed if at_s <= self.now_s - 100.0]
        del self.typed[: len(keys)]
        return keys


def player(clock: Clock, offsets: Sequence[float], speed: float, start_s: float = 0.0) -> Player:
    recorded = [PortNews(1000.0 + offset, str(offset), is_open=True) for offset in offsets]
    played = Player(lambda: iter(recorded), speed, 0.2, start_s, clock)
    played.wait = clock.wait
    return played


def heard(clock: Clock, played: Player) -> list[tuple[float, float]]:
    """When each event was played, and its place in the recording."""
    return [(round(clock() - 100.0, 2), event.time_s - 1000.0) for _, due in played for event in due]


@pytest.mark.parametrize("speed", [0.5, 1.0, 10.0])
def test_events_are_played_at_their_pace(speed: float) -> None:
    clock = Clock()
    played: list[tuple[float, Event]] = []
    last_tick_s = clock()
    for _, due in player(clock, [0.0, 0.5, 0.5, 3.0], speed):
        assert clock() - last_tick_s <= 0.2 + 1e-9, "the display is fed at least every tick"
        last_tick_s = clock()
        played += [(clock() - 100.0, event) for event in due]
    assert [event.port for _, event in played] == ["0.0", "0.5", "0.5", "3.0"]
    assert [at_s for at_s, _ in played] == pytest.approx(
        [0.0, 0.5 / speed, 0.5 / speed, 3.0 / speed], abs=1e-3
    )


def test_a_replay_from_later_on_plays_what_was_before_at_once() -> None:
    clock = Clock()
    assert heard(clock, player(clock, [0.0, 50.0, 61.0], 2.0, 60.0)) == [(0.0, 0.0), (0.0, 50.0), (0.5, 61.0)]


def test_speed_0_never_waits() -> None:
    clock = Clock()
    assert len(heard(clock, player(clock, [0.0, 1e6], 0.0))) == 2
    assert clock() == 100.0


def test_a_pause_lasts_as_long_as_it_lasts() -> None:
    clock = Clock([(1.0, " "), (8.0, " ")])
    assert heard(clock, player(clock, [0.0, 2.0], 1.0)) == [(0.0, 0.0), (9.0, 2.0)]


def test_going_forward_plays_what_is_between_at_once_even_in_a_pause() -> None:
    clock = Clock([(1.0, " "), (2.0, "right")])
    played = player(clock, [0.0, 5.0, 10.5, 12.0, 30.5], 1.0)
    clock.typed += [(4.0, "right"), (6.0, "right"), (7.0, " ")]
    assert heard(clock, played) == [(0.0, 0.0), (2.0, 5.0), (2.0, 10.5), (4.0, 12.0), (6.0, 30.5)]


def test_going_back_begins_again_and_plays_what_is_before_at_once() -> None:
    clock = Clock([(14.0, "left")])
    played = player(clock, [0.0, 3.0, 6.0, 15.0], 1.0)
    begun: list[float] = []
    played.begin_again = lambda: begun.append(clock() - 100.0)
    assert heard(clock, played) == [
        (0.0, 0.0), (3.0, 3.0), (6.0, 6.0), (14.0, 0.0), (14.0, 3.0), (16.0, 6.0), (25.0, 15.0)
    ]  # fmt: skip
    assert begun == pytest.approx([14.0])


def test_what_can_be_read_only_once_does_not_go_back() -> None:
    clock = Clock([(2.0, "left")])
    played = player(clock, [0.0, 3.0], 1.0)
    assert played.keys.startswith("space: pause, right: 10 s, up")
    assert heard(clock, played) == [(0.0, 0.0), (3.0, 3.0)]


def test_the_speed_is_doubled_and_halved_within_bounds() -> None:
    clock = Clock([(1.0, "up"), (2.0, "down"), (3.0, "down")])
    assert heard(clock, player(clock, [0.0, 5.0], 1.0)) == [(0.0, 0.0), (5.0, 5.0)]
    for key, bound in (("up", FASTEST), ("down", SLOWEST)):
        clock = Clock([(0.0, key)] * 30)
        played = player(clock, [0.0, 1.0], 1.0)
        heard(clock, played)
        assert played.status.endswith(f"x {bound:g}")


def test_q_ends_it_at_once_even_where_nothing_waits() -> None:
    clock = Clock([(1.0, "q")])
    assert heard(clock, player(clock, [0.0, 5.0], 1.0)) == [(0.0, 0.0)]
    clock = Clock([(1.0, "q")])
    played = player(clock, range(1000), 0.0)
    count = 0
    for _ in played:
        count += 1
        clock.now_s += 0.1  # so slow is the display
    assert count in (10, 11, 12)
