"""The monitor's live picture fits the terminal, whatever is heard."""

from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from support.heard_fleet import STATE, HeardFleet
from support.strategies import sentences
from tilenca.fleet.grid import Grid
from tilenca.fleet.side_hints import SUPPLY_REMEDY
from tilenca.fleet.state import Event, PortNews
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import ErrorSentence, TileSentence
from tilenca.views.fleet_live import LiveView

said: st.SearchStrategy[Event] = st.one_of(
    st.builds(PortNews, st.just(1.0), st.sampled_from("abc"), st.booleans(), st.text(max_size=5)),
    st.builds(Heard, st.floats(0, 9), st.sampled_from("abc"), st.binary(max_size=9), st.none() | sentences),
)


@given(st.lists(said, max_size=30), st.integers(1, 90), st.integers(1, 40), st.booleans())
def test_whatever_is_heard_the_picture_fits_the_terminal(
    events: list[Event], width: int, height: int, table: bool
) -> None:
    lab = HeardFleet()
    view = LiveView(lab.fleet, Grid(), Console(width=width, height=height), table)
    for event in events:
        lab.take(event)
        view.show(9.0, [event])
    lines = view.lines(width, height)
    assert len(lines) <= height
    assert all(line.cell_len <= width for line in lines)


def test_on_a_narrow_terminal_the_log_says_what_happens_and_not_where_ports_are() -> None:
    lab, port = HeardFleet(), "/a/folder/far/away/from/all/others/tiles/tile-03"
    view = LiveView(lab.fleet, Grid(), Console(width=50, height=24), table=False)
    lab.open(port)
    for label in "49":
        said = Heard(1.0, port, b"", TileSentence(3, 100, 1, label, int(label), 30, "----", STATE))
        lab.take(said)
        view.show(1.0, [said])
    assert view.lines(50, 24)[-1].plain.endswith(" tile   3 tile-03 shows 9, before 4")


def test_a_remedy_is_never_cut_off_and_a_dead_tile_is_named() -> None:
    lab, port = HeardFleet(), "/dev/ttyACM0"
    view = LiveView(lab.fleet, Grid(), Console(width=60, height=24), table=False)
    lab.open(port)
    sag = Heard(1.0, port, b"", ErrorSentence(3, 100, "SUPPLY", "4312 mV"))
    for event in (Heard(1.0, port, b"", TileSentence(3, 100, 1, "4", 4, 30, "----", STATE)), sag):
        lab.take(event)
        view.show(1.0, [event])
    log = " ".join(line.plain.strip() for line in view.lines(60, 24)[6:])
    assert f"SUPPLY 4312 mV: {SUPPLY_REMEDY}" in log
    view.show(9.0, [])
    assert "1 silent (tile 3)" in view.lines(60, 24)[0].plain
