"""The fleet as a table, and events as lines of a log."""

from rich.console import Console

from support.heard_fleet import HeardFleet
from support.tile_port import STATE
from tilenca.fleet.state import Fleet, PortNews, TileView
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import (
    AckSentence,
    BoardSentence,
    ErrorSentence,
    HelloSentence,
    LinkSentence,
    NakSentence,
    OtherVersionSentence,
    Sentence,
    TileSentence,
    TimeSentence,
)
from tilenca.views.fleet_table import HEADER, cells, live_table, log_line, summary


def test_a_log_line_names_time_port_and_tile() -> None:
    sentences: dict[str, Sentence] = {
        "tile 7 TILE shows nothing update 0 up 0.5 s links ----": TileSentence(
            7, 500, 0, "", None, None, "----", STATE
        ),
        "tile 7 LINK W sent 1 received 2 corrupt 3 lost 4 foreign 5 overruns 6 age never": LinkSentence(
            7, 0, "W", 1, 2, 3, 4, 5, None, 6, None, None
        ),
        "tile 7 LINK W sent 1 received 2 corrupt 3 lost 4 foreign 5 overruns 6 age 12 ms from tile 9 E": (
            LinkSentence(7, 0, "W", 1, 2, 3, 4, 5, 12, 6, 9, "E")
        ),
        "tile 7 HELLO protocol 3 firmware 00C0FFEE model 00AB (21 channels, 10 classes) every 250 ms "
        "for ever brightness 128 reset by power-on and watchdog": (
            HelloSentence(3, 7, 0xAB, 21, 10, 250, 0, 9, 0xC0FFEE, 128)
        ),
        "tile 7 TIME computes 14200 us awake 16.3 % longest turn 2048 us stack 5000 bytes unused "
        "3 sentences dropped": TimeSentence(7, 0, 14200, 163, 2048, 5000, 3),
        "tile 7 BOARD supply 4.38 V framing errors N 1 E 0 S 0 W 9 low for N 0 ms E 0 ms S 800 ms W 0 ms": (
            BoardSentence(7, 0, 4380, (1, 0, 0, 9), (0, 0, 800, 0))
        ),
        "tile 7 ERROR SETTINGS defaults in force": ErrorSentence(7, 0, "SETTINGS", "defaults in force"),
        "tile 7 ACK SET period 20": AckSentence(7, "SET", ("period", "20")),
        "tile 7 NAK SET: wrong field": NakSentence(7, "VALUE", "SET"),
        "tile 7 NAK sentence: damaged": NakSentence(7, "CHECKSUM"),
        "tile 7 OTHER speaks protocol 1, these tools speak 3: flash it with the firmware that belongs to "
        "them (tilenca flash)": OtherVersionSentence(1, 7),
    }
    for expected, sentence in sentences.items():
        line = log_line(Heard(0.0, "/dev/ttyACM0", b"", sentence))
        assert line.endswith(f":00.000 /dev/ttyACM0 {expected}")


def test_a_line_that_stays_low_is_noted() -> None:
    view = TileView("p")
    view.take(PortNews(0.0, "p", is_open=True))
    view.take(Heard(1.0, "p", b"", BoardSentence(7, 1000, 5000, (0, 3, 0, 0), (0, 0, 900, 0))))
    assert cells(view, 1.0)[-1] == "E no stop bits, S low"
    view.take(Heard(2.0, "p", b"", BoardSentence(7, 2000, 5000, (0, 3, 0, 0), (0, 0, 900, 0))))
    assert cells(view, 2.0)[-1] == ""


def test_what_a_tile_says_is_missing_is_noted() -> None:
    """Seven channels: the seed's, the four directions, two classes; messages are sent with 128 added."""
    view = TileView("p")
    view.take(PortNews(0.0, "p", is_open=True))
    for directions, scores, note in (
        (4, (0, 33, 40, 0), "none at S"),
        (4, (40, 40, 0, 0), "none at N"),
        (4, (32, 32, 0, 32), ""),
        (0, (0, 33, 40, 0), ""),
    ):
        view.take(Heard(1.0, "p", b"", HelloSentence(3, 7, 0, 7, 2, 100, 0, 0, 0, 255, directions)))
        state = bytes(128 + score for score in (64, *scores, 64, 0))
        view.take(Heard(1.1, "p", b"", TileSentence(7, 100, 1, "4", 0, 64, "N-S-", state)))
        assert cells(view, 1.2)[-1] == note


def test_a_tile_that_fell_silent_is_marked() -> None:
    view = TileView("p")
    view.take(PortNews(0.0, "p", is_open=True))
    view.take(Heard(10.0, "p", b"", HelloSentence(3, 7, 0, 21, 10, 10000, 0, 0, 0, 255)))
    assert cells(view, 25.0)[-1] == ""
    assert cells(view, 31.0)[-1] == "silent"
    view.take(PortNews(32.0, "p", is_open=False, reason="went away"))
    assert cells(view, 33.0)[-1] == "went away"


def test_a_tile_of_another_protocol_version_is_marked() -> None:
    view = TileView("p")
    view.take(PortNews(0.0, "p", is_open=True))
    view.take(Heard(1.0, "p", b"", OtherVersionSentence(1, 7)))
    assert cells(view, 1.0)[-1] == "speaks protocol 1: flash it"
    view.take(Heard(2.0, "p", b"", HelloSentence(3, 7, 0, 21, 10, 100, 0, 0, 0, 255)))
    view.take(Heard(3.0, "p", b"", ErrorSentence(7, 0, "STACK", "")))
    assert cells(view, 3.0)[-1] == "STACK"


def rendered(fleet: Fleet, now_s: float, width: int) -> list[str]:
    """The lines of the live table on a terminal of that width."""
    console = Console(width=width, height=50)
    with console.capture() as captured:
        console.print(live_table(fleet, now_s, width))
    return captured.get().splitlines()


def twenty_tiles() -> Fleet:
    lab = HeardFleet()
    for number in range(20, 0, -1):
        port = f"/dev/ttyACM{number + 80}"
        lab.open(port)
        label, margin = ("", None) if number == 3 else ("4", 100 + number)
        state = TileSentence(number, 1_234_000, 99_990 + number, label, 4, margin, "N-SW", STATE)
        lab.say(port, state, LinkSentence(number, 0, "W", 1, 49_999, 3, 120, 0, 9, 0, None, None))
    return lab.fleet


def test_on_eighty_columns_every_row_is_whole_and_the_last_columns_are_those_that_matter() -> None:
    head, *rows = rendered(twenty_tiles(), 1.5, 80)
    assert head.split() == [
        "PORT",
        "TILE",
        "SHOWS",
        "MARGIN",
        "UPDATE",
        "LINKS",
        "CORRUPT",
        "LOST",
        "HEARD",
        "NOTE",
    ]
    assert rows[0].split() == ["ttyACM81", "1", "4", "101", "99991", "N-SW", "3", "120", "0.5", "s", "ago"]
    assert rows[2].split()[:4] == ["ttyACM83", "3", "nothing", "-"]
    assert len(rows) == 20
    assert not any("…" in line for line in (head, *rows))


def test_a_wide_terminal_shows_all_columns_and_where_the_ports_are() -> None:
    head, first, *_ = rendered(twenty_tiles(), 1.5, 140)
    assert head.split() == " ".join(HEADER).split()
    assert first.startswith("/dev/ttyACM81 ")


def test_a_long_note_takes_the_room_that_is_left_and_costs_no_column() -> None:
    fleet = twenty_tiles()
    reason = "it was unplugged, or another program took it"
    fleet.take(PortNews(2.0, "/dev/ttyACM85", is_open=False, reason=reason))
    head, *rows = rendered(fleet, 2.0, 80)
    assert "MARGIN" in head
    [told] = [row for row in rows if row.startswith("ttyACM85 ")]
    assert len(told) == 80
    assert "  it was unpl" in told


def test_ports_of_one_name_in_two_folders_keep_their_folders() -> None:
    lab = HeardFleet()
    lab.open("/some/lab/tile-01", "/another/lab/tile-01", "/another/lab/tile-02")
    _, *rows = rendered(lab.fleet, 1.0, 80)
    assert [row.split()[0] for row in rows] == ["/another/lab/tile-01", "tile-02", "/some/lab/tile-01"]


def test_tables_are_in_the_order_of_the_tiles_whatever_is_heard_first() -> None:
    lab = HeardFleet()
    lab.open("p10", "p9", "c", "b", "a")
    lab.say("a", TileSentence(10, 100, 7, "4", 4, 30, "----", STATE))
    lab.say("b", TileSentence(9, 100, 7, "4", 4, 30, "----", STATE))
    lab.say("c", TileSentence(0, 100, 7, "4", 4, 30, "----", STATE))  # has no id yet
    expected = ["b", "a", "c", "p9", "p10"]
    assert [row.split()[0] for row in rendered(lab.fleet, 1.0, 80)[1:]] == expected
    assert [row.split()[0] for row in summary(lab.fleet.tiles.values()).splitlines()[1:]] == expected
