"""What is kept of a tile's reports: when its program began, and when it first updated."""

import pytest

from tilenca.emulator.voice import Voice
from tilenca.protocol.sentences import TileSentence, framed, parse_sentence


def report(uptime_ms: int, updates: int) -> TileSentence:
    sentence = parse_sentence(framed(f"TILE,7,{uptime_ms},{updates},4,4,38,N-SW,80C07F"))
    assert isinstance(sentence, TileSentence)
    return sentence


def test_the_first_report_tells_when_the_program_began() -> None:
    voice = Voice()
    voice.note(report(200, 0), said_s=1.3, rate=1.0)
    voice.note(report(300, 5), said_s=1.45, rate=1.0)  # said late
    assert voice.started_s == pytest.approx(1.1)
    assert voice.first_update_s == 1.45
    assert len(voice.reports) == 2


def test_a_fast_clock_tells_less_time_than_it_says() -> None:
    voice = Voice()
    voice.note(report(1100, 1), said_s=2.0, rate=1.1)
    assert voice.started_s == pytest.approx(1.0)


def test_a_reset_forgets_the_reports() -> None:
    voice = Voice()
    voice.note(report(200, 3), said_s=1.3, rate=1.0)
    voice.restart()
    assert (voice.reports, voice.started_s, voice.first_update_s) == ([], None, None)
