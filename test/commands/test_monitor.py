"""The monitor on real pseudo-terminals, as a user runs it."""

import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
import termios
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import IO, Any, Self

import pytest

from support.tile_port import STATE, Tile
from tilenca.cli import main
from tilenca.fleet.reader import PortReader
from tilenca.fleet.recording import format_event
from tilenca.fleet.state import Event, PortNews
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import (
    LinkSentence,
    TileSentence,
    format_sentence,
)

LIMIT_S = 60


@pytest.fixture
def tiles() -> Iterator[list[Tile]]:
    with ExitStack() as stack:
        yield [stack.enter_context(Tile(number)) for number in (1, 2, 3)]


class Monitor:
    """A running `tilenca monitor`; ends with its block at the latest."""

    def __init__(self, *arguments: str) -> None:
        command = [sys.executable, "-m", "tilenca.cli", "monitor", *arguments]
        # Without a buffer of ours, select() sees all that is there.
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, bufsize=0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *about: object) -> None:
        self.process.kill()
        self.process.communicate()

    def read_until(self, stream: IO[bytes] | None, wanted: Callable[[str], bool]) -> list[str]:
        """Lines up to the first that is wanted; fails if none comes."""
        assert stream is not None
        lines: list[str] = []
        while not lines or not wanted(lines[-1]):
            ready, _, _ = select.select([stream], [], [], LIMIT_S)
            line = stream.readline().decode() if ready else ""
            assert line, f"the monitor ended or fell silent after {lines}"
            lines.append(line.rstrip("\n"))
        return lines

    def interrupt(self) -> tuple[str, str]:
        """Ctrl-C; the rest of stdout and stderr."""
        self.process.send_signal(signal.SIGINT)
        output, chatter = self.process.communicate(timeout=LIMIT_S)
        return (output or b"").decode(), chatter.decode()


def ports(*tiles: Tile) -> list[str]:
    return [argument for tile in tiles for argument in ("--port", tile.port)]


def wait_open(monitor: Monitor, stream: IO[bytes] | None, count: int) -> None:
    for _ in range(count):
        monitor.read_until(stream, lambda line: line.endswith("PORT open"))


def test_json_has_one_object_per_sentence_and_damage_on_stderr(tiles: list[Tile]) -> None:
    with Monitor("--json", *ports(*tiles)) as monitor:
        wait_open(monitor, monitor.process.stderr, 3)
        for tile in tiles:
            tile.say()
            tile.write(b"$TILE,dam\x1baged*00\r\n")
            tile.write(format_sentence(LinkSentence(tile.tile, 100, "E", 9, 8, 1, 0, 0, 12, 0, 2, "W")))
        heard: list[dict[str, Any]] = []
        while len(heard) < 6:
            heard.append(json.loads(monitor.read_until(monitor.process.stdout, bool)[-1]))
        _, chatter = monitor.interrupt()
    assert monitor.process.returncode == 130
    for tile in tiles:
        state, link = (about for about in heard if about["port"] == tile.port)
        assert (state["type"], state["tile"], state["fields"]["label"]) == ("TILE", tile.tile, "4")
        assert (link["type"], link["tile"], link["fields"]["corrupt"]) == ("LINK", tile.tile, 1)
        assert f"{tile.port} - DAMAGED $TILE,dam\\x1baged*00" in chatter
    summary = [line.split() for line in chatter.splitlines()]
    assert [*tiles[0].port.split(), "1", "2", "1", "0"] in summary
    assert "Traceback" not in chatter


def test_a_port_that_vanishes_is_told_and_retried_while_the_others_go_on(
    tiles: list[Tile], tmp_path: Path
) -> None:
    steady, shaky, spare = tiles
    cable = tmp_path / "tile"
    cable.symlink_to(shaky.port)
    with Monitor("--port", str(cable), *ports(steady)) as monitor:
        wait_open(monitor, monitor.process.stdout, 2)
        shaky.say()
        monitor.read_until(monitor.process.stdout, lambda line: f"{cable} tile 2 TILE shows 4" in line)
        shaky.unplug()
        cable.unlink()
        monitor.read_until(monitor.process.stdout, lambda line: f"{cable} - PORT went away" in line)
        steady.say()
        monitor.read_until(monitor.process.stdout, lambda line: f"{steady.port} tile 1 TILE" in line)
        cable.symlink_to(spare.port)
        monitor.read_until(monitor.process.stdout, lambda line: line.endswith(f"{cable} - PORT open"))
        spare.say()
        monitor.read_until(monitor.process.stdout, lambda line: f"{cable} tile 3 TILE" in line)
        _, chatter = monitor.interrupt()
    assert monitor.process.returncode == 130
    assert [str(cable), "3", "2", "0", "1"] in [line.split() for line in chatter.splitlines()]


def test_what_is_recorded_is_replayed_through_the_same_view(
    tiles: list[Tile], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = tmp_path / "record.jsonl"
    with Monitor("--record", str(record), *ports(*tiles)) as monitor:
        wait_open(monitor, monitor.process.stdout, 3)
        for tile in tiles:
            tile.write(b"\xfenoise\n")
            tile.say("7")
        live = [
            line
            for _ in tiles
            for line in monitor.read_until(monitor.process.stdout, lambda line: "TILE shows 7" in line)
        ]
        monitor.interrupt()
    assert main(["monitor", "--replay", str(record), "--speed", "0"]) == 0
    replayed = capsys.readouterr().out.splitlines()
    assert replayed[-len(live) :] == live
    assert main(["monitor", "--replay", str(record), "--speed", "0", "--json", "--port", tiles[1].port]) == 0
    [only] = capsys.readouterr().out.splitlines()
    assert (json.loads(only)["tile"], json.loads(only)["fields"]["label"]) == (2, "7")


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    """Ten seconds of two tiles, a sentence a second; after five a 7 becomes a 1."""
    record = tmp_path / "record.jsonl"
    events: list[Event] = []
    for port in ("/lab/tiles/tile-01", "tile-02"):
        events.append(PortNews(1000.0, port, is_open=True))
    for second in range(11):
        for tile, port in ((1, "/lab/tiles/tile-01"), (2, "tile-02")):
            shown = 7 if second < 5 else 1
            said = TileSentence(tile, 1000 * second, second, str(shown), shown, 30, "----", STATE)
            events.append(Heard(1000.0 + second, port, format_sentence(said).strip(), said))
    record.write_text("".join(map(format_event, events)))
    return record


def replayed(record: Path, *options: str) -> list[str]:
    return ["monitor", "--replay", str(record), "--speed", "0", *options]


@pytest.mark.parametrize("manner", [[], ["--json"]])
def test_lines_of_a_replay_begin_where_it_does(
    manner: list[str], recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(replayed(recorded, "--from", "8", *manner)) == 0
    assert len(capsys.readouterr().out.splitlines()) == 6
    assert main(replayed(recorded, "--from", "99", *manner)) == 0
    captured = capsys.readouterr()
    assert captured.out == ""
    assert f"{recorded}: --from 99 is past its end, at 10.0 s" in captured.err


def test_seconds_of_a_replay_count_from_where_it_begins(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(replayed(recorded, "--from", "8", "--seconds", "1")) == 0
    captured = capsys.readouterr()
    assert len(captured.out.splitlines()) == 4
    assert main(replayed(recorded, "--from", "99", "--seconds", "1")) == 0
    assert f"{recorded}: --from 99 is past its end, at 10.0 s" in capsys.readouterr().err


def test_the_log_is_what_is_new(recorded: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(replayed(recorded, "--log", "--from", "3")) == 0
    assert [line.split(" ", 1)[1] for line in capsys.readouterr().out.splitlines()] == [
        "tile   1 /lab/tiles/tile-01 shows 1, before 7",
        "tile   2 tile-02 shows 1, before 7",
    ]


def test_ports_of_a_replay_go_by_the_end_of_their_names_and_none_is_told(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(replayed(recorded, "--port", "tiles/tile-0*")) == 0
    assert {line.split()[1] for line in capsys.readouterr().out.splitlines()} == {"/lab/tiles/tile-01"}
    assert main(replayed(recorded, "--port", "ile-01")) == 3
    assert "no port matches ile-01; it has /lab/tiles/tile-01, tile-02" in capsys.readouterr().err


@pytest.mark.parametrize("options", [["--table"], []])
def test_on_a_terminal_it_is_a_live_view_without_colour_if_so_asked(
    options: list[str], tiles: list[Tile], tmp_path: Path
) -> None:
    record = tmp_path / "record.jsonl"
    with Monitor("--record", str(record), *ports(*tiles)) as monitor:
        wait_open(monitor, monitor.process.stdout, 3)
        for tile in tiles:
            tile.say("7")
            monitor.read_until(monitor.process.stdout, lambda line: "TILE shows 7" in line)
        monitor.interrupt()
    picture = on_terminal(record, (40, 150), options, TERM="xterm-256color", NO_COLOR="1")
    assert "\x1b[3" not in picture, "a colour"
    assert "3 tiles  3 show 7" in picture
    if not options:
        assert "┌─1──" in picture
        assert "╺━┓" in picture
        return
    assert "RECEIVED" in picture
    for tile in tiles:
        row = next(line for line in reversed(picture.splitlines()) if line.split()[:1] == [tile.port])
        assert row.split()[:7] == [tile.port, str(tile.tile), "7", "30", "1", "0", "s"]


@pytest.mark.parametrize("table", [["--table"], []])
def test_a_narrow_terminal_without_unicode_gets_what_fits(table: list[str], tmp_path: Path) -> None:
    record = tmp_path / "record.jsonl"
    events: list[Event] = [PortNews(1.0, "/dev/ttyUSB0", is_open=True)]
    for tile in (1, 2):
        raw = format_sentence(TileSentence(tile, 9, 1, "7", 7, 30, "----", STATE)).strip()
        events.append(Heard(1.0, "/dev/ttyUSB0", raw, None))
    record.write_text("".join(map(format_event, events)))
    picture = on_terminal(record, (20, 40), table, TERM="xterm", PYTHONIOENCODING="ascii")
    assert picture.isascii()
    lines = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", picture).split("PORT  ")[0].splitlines()
    assert max(map(len, lines)) <= 40


def test_a_name_that_the_locale_does_not_know_ends_nothing(tmp_path: Path) -> None:
    record = tmp_path / "record.jsonl"
    record.write_text(format_event(PortNews(1.0, "M\u00fcller", is_open=True)))
    shown = on_terminal(record, (20, 40), [], TERM="dumb", PYTHONIOENCODING="ascii")
    assert "M\\xfcller - PORT open" in shown


def test_a_terminal_that_cannot_move_its_cursor_gets_lines(tmp_path: Path) -> None:
    record = tmp_path / "record.jsonl"
    record.write_text(format_event(PortNews(1.0, "p", is_open=True)))
    assert on_terminal(record, (20, 40), [], TERM="dumb").splitlines()[0].endswith("p - PORT open")


def on_terminal(record: Path, size: tuple[int, int], options: list[str], **environment: str) -> str:
    """What a terminal is sent when a recording is replayed at once."""
    screen, inside = pty.openpty()
    termios.tcsetwinsize(inside, size)
    command = [sys.executable, "-m", "tilenca.cli", "monitor", "--replay", str(record), "--speed", "0"]
    done = subprocess.run(
        [*command, *options],
        stdin=subprocess.DEVNULL,
        stdout=inside,
        stderr=subprocess.PIPE,
        env={**os.environ, **environment},
        timeout=LIMIT_S,
        check=False,
    )
    os.close(inside)
    assert done.returncode == 0, done.stderr
    return read_all(screen)


def read_all(descriptor: int) -> str:
    data = b""
    try:
        while piece := os.read(descriptor, 65536):
            data += piece
    except OSError:
        pass  # Linux's way to say that the other end of a pseudo-terminal is closed
    os.close(descriptor)
    return data.decode()


def test_seconds_end_it_without_an_interrupt(tiles: list[Tile], capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["monitor", "--seconds", "0.1", *ports(*tiles)]) == 0
    assert capfd.readouterr().out.count("PORT open") == 3


def test_a_port_that_never_opened_exits_with_1(tiles: list[Tile], capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["monitor", "--seconds", "0.1", *ports(tiles[0]), "--port", "/dev/no-such-port"]) == 1
    assert "/dev/no-such-port - PORT no such port; waiting for it" in capfd.readouterr().out


def test_two_monitors_do_not_share_a_port(tiles: list[Tile], capfd: pytest.CaptureFixture[str]) -> None:
    with PortReader([tiles[0].port]) as reader:
        [news] = reader.poll(0.0)
        assert isinstance(news, PortNews)
        assert news.is_open
        assert main(["monitor", "--seconds", "0.1", *ports(tiles[0])]) == 1
    assert f"busy: tilenca monitor (pid {os.getpid()})" in capfd.readouterr().out


@pytest.mark.parametrize(
    "arguments",
    [
        ["--replay", "/no/such/file"],
        ["--replay", "/dev/null", "--record", "x"],
        ["--seconds", "-1"],
        ["--speed", "nan"],
        ["--speed", "2", "--port", "/dev/null"],
        ["--from", "2", "--port", "/dev/null"],
    ],
)
def test_bad_arguments_exit_with_2(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    try:
        status: object = main(["monitor", *arguments])
    except SystemExit as ended:
        status = ended.code
    assert status == 2
    assert capsys.readouterr().out == ""


def test_a_record_that_cannot_be_written_is_refused(
    tiles: list[Tile], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["monitor", "--record", "/no/such/place", *ports(tiles[0])]) == 2
    assert "--record" in capsys.readouterr().err


def test_what_is_no_recording_is_not_appended_to(
    tiles: list[Tile], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    readme = tmp_path / "README.md"
    readme.write_text("# Tiles\n")
    assert main(["monitor", "--record", str(readme), *ports(tiles[0])]) == 2
    assert "not a recording; give --record another file" in capsys.readouterr().err
    assert readme.read_text() == "# Tiles\n"


def test_a_record_without_room_ends_it_with_one_line(
    tiles: list[Tile], capfd: pytest.CaptureFixture[str]
) -> None:
    assert main(["monitor", "--seconds", "0.1", "--record", "/dev/full", *ports(tiles[0])]) == 1
    assert capfd.readouterr().err.splitlines()[-1].startswith("tilenca: /dev/full: No space left on device; ")


def test_patterns_may_match_later_and_names_may_not(tiles: list[Tile], tmp_path: Path) -> None:
    with Monitor("--port", f"{tmp_path}/*") as monitor:
        monitor.read_until(monitor.process.stderr, lambda line: line.startswith("nothing matches"))
        (tmp_path / "tile").symlink_to(tiles[0].port)
        wait_open(monitor, monitor.process.stdout, 1)
        monitor.interrupt()
    assert main(["monitor", "--port", f"{tmp_path}/other"]) == 3
