"""How well a link does lately, from the counters that a tile reports."""

from support.heard_fleet import link, three_in_an_l
from tilenca.fleet.grid import Grid, Mark
from tilenca.fleet.link_health import WINDOW_MS, LinkHealth
from tilenca.protocol.sentences import (
    LinkSentence,
)


def report(uptime_ms: int, received: int, lost: int = 0, foreign: int = 0) -> LinkSentence:
    return LinkSentence(7, uptime_ms, "N", 0, received, 0, lost, foreign, 5, 0, 8, "S")


def health(*reports: LinkSentence) -> LinkHealth:
    health = LinkHealth()
    for one in reports:
        health.take(one)
    return health


def test_nothing_is_known_before_frames_were_counted() -> None:
    assert health().good is None
    assert health(report(1000, 50)).good is None, "one report counts since the start, not lately"
    assert health(report(1000, 50), report(2000, 50)).good is None, "no frame came, none was missed"


def test_it_is_the_share_of_the_frames_since_the_first_report() -> None:
    assert health(report(1000, 100), report(2000, 150)).good == 1.0
    assert health(report(1000, 100, 10), report(2000, 175, 35)).good == 0.75
    assert health(report(1000, 100), report(2000, 100, 20)).good == 0.0


def test_what_is_older_than_the_window_is_forgotten() -> None:
    bad = [report(0, 0), report(1000, 0, 50)]
    well = [report(1000 + after, after // 20, 50) for after in range(1000, WINDOW_MS + 1, 1000)]
    assert health(*bad, *well[:-1]).good < 1.0  # type: ignore[operator]
    assert health(*bad, *well).good == 1.0


def test_a_tile_that_restarted_counts_anew() -> None:
    before = [report(5000, 100), report(6000, 100, 50)]
    assert health(*before, report(500, 10)).good is None
    assert health(*before, report(500, 10), report(1500, 60)).good == 1.0
    # Its clock may be past the old one already: then fewer frames tell.
    assert health(*before, report(7000, 10)).good is None


def test_another_model_is_seen_while_its_frames_come() -> None:
    assert not health(report(1000, 0, foreign=9)).foreign, "they may be from long ago"
    assert health(report(1000, 0, foreign=9), report(2000, 0, foreign=12)).foreign
    gone = [report(2000 + after, 0, foreign=12) for after in range(0, WINDOW_MS + 1, 1000)]
    assert not health(report(1000, 0, foreign=9), *gone).foreign


def test_health_is_of_the_last_seconds_and_is_told_before_the_link_is_gone() -> None:
    lab = three_in_an_l()
    received = lost = 0
    for second in range(40):
        received, lost = received + (10 if second < 20 else 8), lost + (0 if second < 20 else 2)
        lab.say("a", link(1, "E", 2, 1000 * second, received, lost))
    assert [text for text in lab.news if "failing" in text] == [
        "link E is failing: 12% of the frames get lost"
    ]
    assert Grid().cells(lab.fleet, 1.0)[0, 0].marks["E"] is Mark.FAILING
    for second in range(40, 55):
        received += 10
        lab.say("a", link(1, "E", 2, 1000 * second, received, lost))
    assert lab.news[-1] == "link E is well again"


def test_health_begins_anew_when_a_tile_restarts() -> None:
    health = LinkHealth()
    assert health.good is None
    for uptime_ms, received, lost in ((0, 100, 0), (1000, 100, 100), (500, 5, 0), (500 + WINDOW_MS, 15, 0)):
        health.take(link(1, "E", 2, uptime_ms, received, lost))
    assert health.good == 1.0


def garbled(uptime_ms: int, corrupt: int, received: int = 0) -> LinkSentence:
    return LinkSentence(7, uptime_ms, "N", 0, received, corrupt, 0, 0, None, 0, None, None)


def test_a_tile_of_which_nothing_arrives_whole_is_told_from_noise_and_from_nobody() -> None:
    assert health(garbled(1000, 0), garbled(2000, 36)).garbled
    assert not health(garbled(1000, 36)).garbled, "one report counts since the start, not lately"
    assert not health(garbled(1000, 0), garbled(2000, 0)).garbled
    assert not health(garbled(1000, 0), garbled(2000, 3)).garbled, "an open input hears noise"
    assert not health(garbled(1000, 0), garbled(2000, 36, received=1)).garbled
    assert not health(garbled(0, 500), *(garbled(ms, 500) for ms in range(1000, 12_000, 1000))).garbled


def test_a_link_that_was_never_good_is_marked_dead_and_told_once() -> None:
    lab = three_in_an_l()
    for second in range(1, 4):
        lab.say("c", LinkSentence(3, 1000 * second, "E", 0, 0, 30 * second, 0, 0, None, 0, None, None))
    assert Grid().cells(lab.fleet, 1.0)[1, 0].marks["E"] is Mark.DEAD
    told = [text for text in lab.news if "whole" in text]
    assert told == [
        "on E is a tile, but no frame of it arrives whole: check the plug, and that both run one model"
    ]
    lab.say("c", LinkSentence(3, 4000, "E", 0, 40, 95, 0, 0, 5, 0, 9, "W"))
    assert lab.news[-1] == "frames from E are not garbled any more"
