"""Which ports are tiles, what they are called, and who holds them."""

import json
import os
from pathlib import Path

import pytest

from tilenca.cli import main
from tilenca.fleet import listen
from tilenca.fleet.lock import port_lock


def test_devices_prints_one_document_in_stable_order(
    pty: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "tile2").symlink_to(pty)
    (tmp_path / "notes.txt").write_text("not a port")
    assert main(["devices", "--json", "--port", f"{tmp_path}/*"]) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    [device] = json.loads(captured.out)["devices"]
    assert device["port"] == f"{tmp_path}/tile2"
    assert [device[key] for key in ("vid", "pid", "serial_number", "tile")] == [None] * 4


def test_a_named_port_that_is_missing_is_told_and_stops_no_other(
    pty: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    missing = tmp_path / "ttyACM9"
    assert main(["devices", "--json", "--port", pty, "--port", str(missing)]) == 0
    captured = capsys.readouterr()
    assert [device["port"] for device in json.loads(captured.out)["devices"]] == [pty]
    assert captured.err == f"{missing}: no such port\n"


def test_the_list_says_how_to_ask_the_tiles(pty: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["devices", "--port", pty]) == 0
    captured = capsys.readouterr()
    assert captured.out.splitlines()[1].startswith(pty)
    [hint] = captured.err.splitlines()
    assert hint.startswith("next: tilenca devices --ask asks each tile for its id and firmware")


@pytest.mark.parametrize("command", ["devices", "flash", "monitor"])
@pytest.mark.parametrize("pattern", ["ttyACM*", "ttyACM0"])
def test_no_device_exits_with_3_and_a_remedy(
    command: str,
    pattern: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(listen, "PATIENCE_S", 0.0)
    assert main([command, "--port", str(tmp_path / pattern)]) == 3
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert "`tilenca devices` lists" in captured.err


def test_where_no_port_may_be_opened_nothing_is_learnt_and_flashing_is_not_advised(
    pty: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "tiles.toml"
    file.write_text("of somebody's own")
    with port_lock(pty, "tilenca flash"):
        assert main(["devices", "--learn", "--tiles", str(file), "--port", pty]) == 1
    first, last = capsys.readouterr().err.splitlines()
    assert first == f"{pty}: busy: tilenca flash (pid {os.getpid()}) has it open; left out"
    assert last.endswith(": no tile answers")
    assert file.read_text() == "of somebody's own"
