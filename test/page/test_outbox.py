"""The outbox: one that reads gets all, one that is slow the latest and all changes, and nothing grows."""

import shutil
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from support.page_node import PageNode
from support.vectors import cases
from tilenca.base import paths
from tilenca.page.outbox import MOST_CHANGES, MOST_FRAMES, MOST_REFUSALS, MOST_UNSEEN, Outbox, subject_of
from tilenca.protocol import stream
from tilenca.protocol.sentences import HelloSentence, TileSentence, framed, parse_sentence

PORTS = [f"tile-{number:02d}" for number in range(1, 5)]


def tile(port: str, updates: int) -> stream.StreamEvent:
    return stream.raw_event(updates, port, framed(f"TILE,1,{updates},{updates},4,4,3,----,80").strip())


def shows(port: str, label: str, time_s: float = 0) -> stream.StreamEvent:
    sure = "4,3" if label else ","
    return stream.raw_event(time_s, port, framed(f"TILE,1,7,7,{label},{sure},----,80").strip())


def starts(port: str, asked: bool = False) -> stream.StreamEvent:
    event = stream.raw_event(0, port, framed("HELLO,3,1,D968,21,10,20,0,01,54AB570B,255").strip())
    return {**event, "asked": True} if asked else event


def link(port: str, side: str, sent: int) -> stream.StreamEvent:
    return stream.raw_event(sent, port, framed(f"LINK,1,{sent},{side},{sent},0,0,0,0,,0,,").strip())


def test_events_come_in_their_order() -> None:
    outbox = Outbox()
    events = [stream.place_event(0, port, (0, 1)) for port in PORTS] + [tile(port, 1) for port in PORTS]
    outbox.put(events)
    assert outbox.take() == (1, events)
    assert not outbox.may_send


def test_of_what_waits_the_latest_counts() -> None:
    outbox = Outbox()
    outbox.put([tile(port, 0) for port in PORTS])
    assert len(outbox.take()[1]) == len(PORTS)
    for updates in range(1000):
        outbox.put([tile(port, updates) for port in PORTS])
        outbox.put([link("tile-01", "NESW"[updates % 4], updates)])
        outbox.put([stream.pace_event(updates, 1, False, 1, 0)])
    _, events = outbox.take()
    assert events == [
        link("tile-01", "N", 996), link("tile-01", "E", 997), link("tile-01", "S", 998),
        *(tile(port, 999) for port in PORTS), link("tile-01", "W", 999),
        stream.pace_event(999, 1, False, 1, 0),
    ]  # fmt: skip


def test_of_lines_that_are_no_sentence_the_latest_of_each_tile_waits() -> None:
    outbox = Outbox()
    outbox.put([tile("tile-01", 7)])
    for n in range(1000):
        outbox.put(
            [stream.raw_event(n, "tile-01", line) for line in (b"debug %d, x" % n, b"$LINK,1,2,%d,*00" % n)]
        )
    assert outbox.take()[1] == [tile("tile-01", 7), stream.raw_event(999, "tile-01", b"$LINK,1,2,999,*00")]


def test_a_jump_makes_all_but_the_run_void() -> None:
    outbox = Outbox()
    run, jump = stream.run_event(0, {"seed": 1}), stream.jump_event(2, 5)
    outbox.put([stream.stream_event("emulated"), run, tile("tile-01", 7), stream.refused_event(0, "no")])
    outbox.put([stream.jump_event(1, 5), tile("tile-02", 8), jump, tile("tile-03", 9)])
    assert outbox.take()[1] == [
        stream.stream_event("emulated"), run, stream.refused_event(0, "no"), jump, tile("tile-03", 9)
    ]  # fmt: skip


def test_frames_and_refusals_have_an_end() -> None:
    outbox = Outbox()
    outbox.put([stream.frame_event(n, "tile-01", "E", b"\1") for n in range(5 * MOST_FRAMES)])
    outbox.put([stream.refused_event(n, "no") for n in range(5 * MOST_REFUSALS)])
    _, events = outbox.take()
    assert len([event for event in events if "frame" in event]) == MOST_FRAMES
    assert [event["time"] for event in events if "refused" in event] == list(range(32, 40))


def test_a_new_run_makes_all_before_it_void() -> None:
    outbox = Outbox()
    first, run = stream.stream_event("emulated"), stream.run_event(0, {})
    outbox.put([first, tile("tile-01", 5), run, tile("tile-02", 1)])
    assert outbox.take()[1] == [first, run, tile("tile-02", 1)]


def test_a_client_that_does_not_look_is_sent_no_more() -> None:
    outbox = Outbox()
    for number in range(1, MOST_UNSEEN + 1):
        outbox.put([tile("tile-01", number)])
        assert outbox.may_send
        assert outbox.take()[0] == number
    outbox.put([tile("tile-01", 9)])
    assert not outbox.may_send
    for wrong in (0, MOST_UNSEEN + 1, 2**50):
        outbox.seen(wrong)
        assert not outbox.may_send
    outbox.seen(1)
    assert outbox.may_send


events = st.one_of(
    st.builds(tile, st.sampled_from(PORTS), st.integers(0, 9)),
    st.builds(link, st.sampled_from(PORTS), st.sampled_from("NESW"), st.integers(0, 9)),
    st.builds(stream.place_event, st.just(0.0), st.sampled_from(PORTS), st.none()),
    st.builds(
        stream.cable_event, st.just(0.0), st.sampled_from(PORTS), st.sampled_from("NESW"), st.booleans()
    ),
    st.builds(stream.raw_event, st.just(0.0), st.sampled_from(PORTS), st.binary(max_size=9)),
    st.builds(stream.frame_event, st.just(0.0), st.sampled_from(PORTS), st.sampled_from("NESW"), st.binary()),
)


@given(st.lists(events, max_size=80))
def test_the_last_of_everything_always_arrives(given_events: list[stream.StreamEvent]) -> None:
    outbox = Outbox()
    for event in given_events:
        outbox.put([event])
    taken = outbox.take()[1] if given_events else []
    assert taken == sorted(
        taken, key=lambda event: max(i for i, one in enumerate(given_events) if one is event)
    )
    if given_events:
        assert taken[-1] == given_events[-1]


def labels_shown(given_events: list[stream.StreamEvent]) -> list[tuple[str, str, float]]:
    """The changes of labels that a page notes, with their times."""
    labels: dict[str, str] = {}
    noted = []
    for event in given_events:
        sentence = parse_sentence(event["raw"]) if "raw" in event else None
        if isinstance(sentence, TileSentence):
            label = sentence.label
        elif event.get("open") is False or (isinstance(sentence, HelloSentence) and not event.get("asked")):
            label = ""
        else:
            continue
        if label != labels.get(event["port"], ""):
            labels[event["port"]] = label
            noted.append((event["port"], label, event["time"]))
    return noted


changes = st.one_of(
    st.builds(shows, st.sampled_from(PORTS[:2]), st.sampled_from(["", "3", "8"]), st.floats(0, 9)),
    st.builds(starts, st.sampled_from(PORTS[:2]), st.booleans()),
    st.builds(stream.open_event, st.floats(0, 9), st.sampled_from(PORTS[:2]), st.booleans(), st.just("")),
)


@given(st.lists(st.tuples(changes, st.sampled_from([False] * 5 + [True])), min_size=20, max_size=80))
def test_a_slow_client_counts_as_many_changes_of_labels_as_a_quick_one(
    given_events: list[tuple[stream.StreamEvent, bool]],
) -> None:
    outbox = Outbox()
    got = []
    for event, is_read in given_events:
        outbox.put([event])
        got += outbox.take()[1] if is_read else []
    got += outbox.take()[1]
    assert labels_shown(got) == labels_shown([event for event, _ in given_events])


def test_changes_of_labels_have_an_end_and_what_a_tile_shows_has_not() -> None:
    outbox = Outbox()
    first = [shows("tile-01", "3"), stream.open_event(0, "tile-01", False, "no power")]
    outbox.put(first)
    outbox.put([shows("tile-02", "38"[n % 2], n) for n in range(2 * MOST_CHANGES)])
    _, events = outbox.take()
    assert events[:2] == first
    assert events[2:] == [shows("tile-02", "38"[n % 2], n) for n in range(MOST_CHANGES - 1, 2 * MOST_CHANGES)]


SUBJECTS = """
import { subjectOf } from "./stream/sentences.js";
import { subjectOf as subjectInTheWorker } from "./subject.js";
const answer = (line) => [subjectOf(line), subjectInTheWorker(line)];
"""


def test_a_line_is_about_the_same_here_on_the_page_and_in_its_emulator(tmp_path: Path) -> None:
    """The page and the emulator for browsers are served apart: neither can use the other's modules."""
    shutil.copy(paths.ROOT / "web" / "src" / "stream" / "subject.js", tmp_path)
    whole = [case[1] for case in cases("sentences.inc")]
    damaged = [line.replace("*", "0*") for line in whole] + [line[1:] for line in whole]
    noise = ["", "$", "$*00", "noise", "$LINK,1,2,N", framed("FLY,1").decode().strip(), "$TILE,1*00"]
    with PageNode(tmp_path, SUBJECTS) as node:
        for line in [*whole, *damaged, *noise]:
            subject = " ".join(filter(None, subject_of(line)))
            assert node.ask(line) == [subject, subject], line
    assert {subject_of(line) for line in damaged + noise} == {("", "")}
    assert {" ".join(subject_of(line)).split()[0] for line in whole} >= {
        "HELLO",
        "TILE",
        "LINK",
        "CHIP",
        "BOARD",
    }
