"""Programming many boards with the real avrdude; what answers it is a stand-in for the bootloader."""

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from support.bootloader_stand_in import ATMEGA_328P, StandIn
from support.intel_hex import image
from tilenca.base import paths
from tilenca.cli import main
from tilenca.fleet import programmer
from tilenca.fleet.avrdude import find_avrdude
from tilenca.fleet.flash_state import failed_boards
from tilenca.fleet.lock import port_lock
from tilenca.fleet.tiles_file import Place, write_tiles

DATA = bytes(index * 7 & 0xFF for index in range(6000))
LIMIT_S = 60
# The stand-ins cannot say what they run: nobody waits for that long.
QUICK = ("--force", "--timeout", "2")


@pytest.fixture
def firmware(tmp_path: Path) -> Path:
    path = tmp_path / "firmware.hex"
    path.write_text(image(DATA))
    return path


def command(firmware: Path, *names: str, options: tuple[str, ...] = ()) -> list[str]:
    named = [argument for name in names for argument in ("--port", name)]
    return [
        sys.executable,
        "-m",
        "tilenca.cli",
        "flash",
        "--hex",
        str(firmware),
        "--json",
        *QUICK,
        *options,
        *named,
    ]


def flash(
    firmware: Path, *names: str, options: tuple[str, ...] = ()
) -> tuple[int, dict[str, dict[str, Any]], str]:
    """(exit status, the document's tiles by port, stderr) of `tilenca flash --json`."""
    done = subprocess.run(
        command(firmware, *names, options=options),
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )
    tiles = json.loads(done.stdout)["tiles"] if done.stdout else []
    return done.returncode, {tile["port"]: tile for tile in tiles}, done.stderr


def test_boards_are_programmed_side_by_side_and_one_bad_board_stops_no_other(firmware: Path) -> None:
    with ExitStack() as stack:
        good = [stack.enter_context(StandIn()) for _ in range(3)]
        bad = {
            "wrong chip: its signature is 0x1e950f": stack.enter_context(StandIn(signature=ATMEGA_328P)),
            "verification failed at 0x0123": stack.enter_context(StandIn(decayed=0x123)),
            "silent while writing": stack.enter_context(StandIn(mute_after=5)),
            "the board went away": stack.enter_context(StandIn(gone_after=5)),
            "no reply from a Mega's bootloader": stack.enter_context(StandIn(silent=True)),
        }
        names = [board.port for board in (*good, *bad.values())]
        status, tiles, chatter = flash(firmware, *names, "/dev/no-such-port")
    assert status == 1
    assert len(tiles) == 9
    for board in good:
        assert tiles[board.port]["result"] == "flashed"
        assert tiles[board.port]["error"] is None
        assert board.flash[: len(DATA)] == DATA
        assert f"{board.port}: flashed (" in chatter
    for reason, board in bad.items():
        assert tiles[board.port]["result"] == "failed"
        assert tiles[board.port]["error"].startswith(reason)
    assert tiles["/dev/no-such-port"]["error"] == "no such port; is the board connected?"
    assert "3 of 9 flashed" in chatter


def test_what_may_pass_is_tried_once_more_and_what_cannot_is_not(firmware: Path) -> None:
    with (
        StandIn(mute_after=5, recovers=True) as hung,
        StandIn(decayed=0x123, recovers=True) as disturbed,
        StandIn(signature=ATMEGA_328P) as wrong,
    ):
        status, tiles, chatter = flash(firmware, hung.port, disturbed.port, wrong.port)
    assert status == 1, chatter
    assert [(tiles[board.port]["result"], tiles[board.port]["attempts"]) for board in (hung, disturbed)] == [
        ("flashed", 2)
    ] * 2
    assert (tiles[wrong.port]["result"], tiles[wrong.port]["attempts"]) == ("failed", 1)
    again = {line.split(": ")[0] for line in chatter.splitlines() if line.endswith(": trying again")}
    assert again == {hung.port, disturbed.port}


def test_the_next_call_with_failed_flashes_those_and_no_other(firmware: Path) -> None:
    with StandIn() as good, StandIn(decayed=0x123) as bad:
        assert flash(firmware, good.port, bad.port)[0] == 1
        bad.decayed = None
        status, tiles, _ = flash(firmware, good.port, bad.port, options=("--failed",))
        assert (status, list(tiles)) == (0, [bad.port])
        status, tiles, chatter = flash(firmware, good.port, bad.port, options=("--failed",))
    assert (status, tiles) == (0, {})
    assert "nothing to do" in chatter


def test_what_was_missing_is_flashed_with_those_that_failed(firmware: Path, tmp_path: Path) -> None:
    cable = tmp_path / "cable"
    with StandIn() as here, StandIn() as loose:
        tiles = tmp_path / "tiles.toml"
        write_tiles(tiles, [Place(1, f"port:{here.port}", 0, 0), Place(2, f"port:{cable}", 0, 1)])
        options = ("--tiles", str(tiles))
        status, _, chatter = flash(firmware, options=options)
        assert status == 1
        assert "--failed" in chatter
        status, rows, chatter = flash(firmware, options=(*options, "--failed"))
        assert (status, [row["result"] for row in rows.values()]) == (1, ["missing"])
        assert "nothing to do" not in chatter
        cable.symlink_to(loose.port)
        status, rows, _ = flash(firmware, options=(*options, "--failed"))
        assert (status, [row["tile"] for row in rows.values()]) == (0, [2])
        assert loose.flash[: len(DATA)] == DATA


def test_what_to_do_is_known_before_anything_is_built(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(paths, "PROJECT", tmp_path)  # no project there: a build would fail
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    with StandIn() as board:
        assert main(["flash", "--only", "x", "--port", board.port]) == 2
        assert main(["flash", "--failed", "--port", board.port]) == 0
    assert "nothing to do" in capsys.readouterr().err


def test_an_interrupt_before_a_board_is_begun_is_one_like_any(
    firmware: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(programmer, "holders", interrupt)
    with StandIn() as first, StandIn() as second:
        names = [first.port, second.port]
        done = programmer.program_all(find_avrdude(), firmware, names, 2, 2.0, lambda *news: None)
    assert [(outcome.port, outcome.result) for outcome in done] == [(name, "interrupted") for name in names]


def test_a_tile_that_is_wanted_and_missing_is_a_row_and_remembered(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(paths, "PROJECT", tmp_path)  # no project there: a build would fail
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    gone = f"port:{tmp_path}/gone"
    file = tmp_path / "tiles.toml"
    with StandIn() as board:
        write_tiles(file, [Place(1, f"port:{board.port}", 0, 0), Place(3, gone, 0, 1)])
        assert main(["flash", "--only", "3", "--json", "--tiles", str(file)]) == 1
        assert main(["flash", "--only", "4", "--tiles", str(file)]) == 3
    [row] = json.loads(capsys.readouterr().out)["tiles"]
    assert (row["tile"], row["result"]) == (3, "missing")
    assert failed_boards() == {gone}


def test_all_well_exits_with_0_with_fewer_jobs_than_boards(firmware: Path) -> None:
    with StandIn() as first, StandIn() as second, StandIn() as third:
        boards = (first, second, third)
        status, tiles, chatter = flash(firmware, *(board.port for board in boards), options=("--jobs", "1"))
        assert status == 0, chatter
        assert all(board.flash[: len(DATA)] == DATA for board in boards)
    # One at a time: a board is connected to only after the one before is done.
    phases = [line.split(": ", 1)[1] for line in chatter.splitlines() if line.startswith("/dev/pts/")]
    assert [phase for phase in phases if phase in ("connecting", "confirming")] == [
        "connecting",
        "confirming",
    ] * 3
    assert {tile["result"] for tile in tiles.values()} == {"flashed"}


def test_the_order_of_the_document_is_that_of_the_ports(firmware: Path, tmp_path: Path) -> None:
    with StandIn() as first, StandIn() as second:
        for name, board in (("tile10", first), ("tile9", second)):
            (tmp_path / name).symlink_to(board.port)
        _, tiles, _ = flash(firmware, f"{tmp_path}/tile*")
    assert list(tiles) == [f"{tmp_path}/tile9", f"{tmp_path}/tile10"]


def test_without_json_stdout_is_a_table(firmware: Path) -> None:
    with StandIn() as board:
        arguments = [argument for argument in command(firmware, board.port) if argument != "--json"]
        done = subprocess.run(arguments, capture_output=True, text=True, timeout=LIMIT_S, check=False)
    header, row = done.stdout.splitlines()
    assert header.split() == ["PORT", "TILE", "RESULT", "SECONDS", "FIRMWARE", "WHY"]
    assert row.split()[:3] == [board.port, "-", "flashed"]


def test_a_board_without_permission_says_what_to_do(firmware: Path) -> None:
    with StandIn() as board:
        Path(board.port).chmod(0)
        arguments = command(firmware, board.port)
        if os.geteuid() == 0:
            # Root may open everything, unless it gives that right away.
            setpriv = shutil.which("setpriv")
            if setpriv is None:
                pytest.skip("root needs setpriv (util-linux) to give up its rights")
            arguments = [setpriv, "--bounding-set=-dac_override,-dac_read_search", *arguments]
        done = subprocess.run(arguments, capture_output=True, text=True, timeout=LIMIT_S, check=False)
    assert done.returncode == 1, done.stderr
    [tile] = json.loads(done.stdout)["tiles"]
    assert tile["error"] == "permission denied; these emulated tiles are another user's: serve your own"


def test_a_port_in_use_says_by_whom(firmware: Path) -> None:
    with StandIn() as ours, StandIn() as theirs:
        with port_lock(ours.port, "tilenca monitor"):
            program = f"f = open({theirs.port!r}); print(flush=True); input()"
            with subprocess.Popen(
                [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE
            ) as other:
                assert other.stdout is not None
                other.stdout.readline()
                status, tiles, _ = flash(firmware, ours.port, theirs.port)
                other.communicate(b"\n", timeout=LIMIT_S)
        assert not ours.heard.is_set()
        assert not theirs.heard.is_set()
    assert status == 1
    assert tiles[ours.port]["error"].startswith("busy: tilenca monitor ")
    for board, holder in ((ours, os.getpid()), (theirs, other.pid)):
        assert tiles[board.port]["error"].endswith(
            f"(pid {holder}) has it open; close that, then flash again"
        )


def test_a_bad_image_is_refused_before_any_board_is_touched(firmware: Path) -> None:
    firmware.write_text(image(b"three bangs !!!!"))
    with StandIn() as board:
        status, tiles, chatter = flash(firmware, board.port)
        assert not board.heard.is_set()
    assert (status, tiles) == (2, {})
    assert "hang some Mega bootloaders" in chatter


def avrdudes_on(name: str) -> list[str]:
    """Command lines of running avrdudes with this port."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            words = (process / "cmdline").read_bytes().decode().split("\0")
        except OSError:
            continue
        if "avrdude" in words[0] and name in words:
            found.append(" ".join(words))
    return found


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupt_exits_with_130_and_leaves_nothing_running(
    firmware: Path, number: signal.Signals
) -> None:
    with StandIn(silent=True) as stuck, StandIn() as waiting:
        arguments = command(
            firmware, stuck.port, waiting.port, options=("--jobs", "1", "--timeout", str(LIMIT_S))
        )
        flashing = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert stuck.heard.wait(LIMIT_S), "avrdude never spoke"
        assert avrdudes_on(stuck.port), "the search must be able to find one"
        flashing.send_signal(number)
        output, chatter = flashing.communicate(timeout=LIMIT_S)
        assert avrdudes_on(stuck.port) == []
        assert not waiting.heard.is_set()
    assert flashing.returncode == 130, chatter
    tiles = {tile["port"]: tile for tile in json.loads(output)["tiles"]}
    assert {tile["result"] for tile in tiles.values()} == {"interrupted"}
    assert (tiles[stuck.port]["attempts"], tiles[waiting.port]["attempts"]) == (1, 0)
    assert tiles[stuck.port]["seconds"] > 0.0 == tiles[waiting.port]["seconds"]
    assert "Traceback" not in chatter


def test_nobody_listening_to_the_chatter_stops_no_work(firmware: Path) -> None:
    listener, chatter = os.pipe()
    os.close(listener)
    with StandIn() as board:
        done = subprocess.run(
            command(firmware, board.port),
            stdout=subprocess.PIPE,
            stderr=chatter,
            text=True,
            timeout=LIMIT_S,
            check=False,
        )
        assert board.flash[: len(DATA)] == DATA
    os.close(chatter)
    assert done.returncode == 0
    assert [tile["result"] for tile in json.loads(done.stdout)["tiles"]] == ["flashed"]


def test_the_stand_in_ends_with_its_block() -> None:
    before = threading.active_count()
    with StandIn():
        assert threading.active_count() == before + 1
    assert threading.active_count() == before
