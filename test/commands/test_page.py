"""`tilenca page` as a user starts it."""

import argparse
import builtins
import re
import socket
import sys
from pathlib import Path
from typing import Any

import pytest
from serial.tools.list_ports_common import ListPortInfo

from support.page_server import page_server
from support.web_socket import WebSocketClient, get
from tilenca import cli
from tilenca.base import paths
from tilenca.commands import page as commands_page
from tilenca.commands.page import address


def page(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str]:
    """Exit status and stderr of a start that fails."""
    try:
        status = cli.main(["page", "--no-open", *map(str, arguments)])
    except SystemExit as ended:
        status = int(ended.code or 0)
    said = capsys.readouterr()
    assert said.out == ""
    return status, said.err


def test_its_address_is_the_first_line_and_ctrl_c_ends_it(firmware: Path) -> None:
    with page_server(firmware) as server:
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/", server.url)
        client = WebSocketClient(server.address)
        client.watch("stream")
        assert server.stop() == 130


def test_it_offers_the_drawings_of_the_files_it_was_given(firmware: Path) -> None:
    with page_server(firmware, ["--shapes", "hex", "--shapes", "digits-3x3"]) as server:
        client = WebSocketClient(server.address)
        first = client.watch("stream")
        client.close()
    names = [drawing["name"] for drawing in first["drawings"]]
    assert names[:2] == ["hex/0", "hex/1"]
    assert "digits-3x3/7@2" in names
    assert [look["label"] for look in first["looks"]][10:] == ["A", "b", "C", "d", "E", "F", "-"]


def test_a_port_that_is_taken_is_one_line(firmware: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        where = f"127.0.0.1:{taken.getsockname()[1]}"
        status, said = page(capsys, "--elf", firmware, "--listen", where)
    assert (status, said) == (
        2,
        f"tilenca: --listen {where}: Address already in use; give another, such as 127.0.0.1:0\n",
    )


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["--listen", "8137"], "'8137' is not HOST:PORT"),
        (["--listen", "localhost:99999"], "is not HOST:PORT"),
        (["--shapes", "none.toml"], "none.toml: No such file"),
        (
            ["--elf", "none.elf"],
            "none.elf: No such file or directory; run `make demo` or `pio run`, or give --elf",
        ),
    ],
)
def test_what_cannot_be_used_is_one_line(
    words: list[str], complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    status, said = page(capsys, *words)
    assert status == 2
    assert complaint in said
    assert said.count("\n") == 1


@pytest.mark.parametrize(
    ("text", "parsed"),
    [("localhost:0", ("localhost", 0)), ("0.0.0.0:80", ("0.0.0.0", 80)), ("[::1]:8137", ("::1", 8137))],
)
def test_an_address_is_host_and_port(text: str, parsed: tuple[str, int]) -> None:
    assert address(text) == parsed


@pytest.mark.parametrize("text", ["", ":", "host", "host:", ":80", "host:-1", "host:1x"])
def test_what_is_no_address_is_refused(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match="HOST:PORT"):
        address(text)


def test_without_its_extra_it_says_how_to_get_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], firmware: Path
) -> None:
    real = builtins.__import__

    def without_starlette(name: str, *rest: Any, **more: Any) -> Any:
        if name.partition(".")[0] == "starlette":
            raise ModuleNotFoundError("No module named 'starlette'", name="starlette")
        return real(name, *rest, **more)

    for name in [name for name in sys.modules if name.startswith(("tilenca.page", "starlette"))]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(builtins, "__import__", without_starlette)
    assert page(capsys, "--elf", firmware) == (2, "tilenca: the page needs starlette; run: make setup\n")


def test_the_bundle_loads_nothing_from_elsewhere() -> None:
    texts = {path: path.read_text(encoding="utf-8") for path in paths.PAGE.rglob("*") if path.is_file()}
    assert len(texts) > 15
    for path, text in texts.items():
        found = re.findall(r"(?:https?:)?//[\w.-]+\.\w+", text.replace("http://www.w3.org/2000/svg", ""))
        assert found == [], path


def test_options_that_would_be_ignored_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for words, complaint in (
        (["--record", "x"], "--record does nothing without --port"),
        (["--tiles", "x"], "--tiles does nothing without --port"),
        (["--html", "x"], "--html does nothing without --replay"),
        (["--replay", "x", "--html", "y", "--listen", "127.0.0.1:0"], "leave --listen out"),
        (["--port", "x", "--elf", "y"], "--elf is for emulated tiles"),
        (["--port", "x", "--model", "y"], "--model is for emulated tiles"),
        (["--replay", "x", "--port", "y"], "--replay shows a recording, and no tiles"),
        (["--replay", str(tmp_path / "none")], "No such file"),
        (["--model", str(tmp_path / "none")], "none"),
    ):
        status, said = page(capsys, *words)
        assert status == 2, words
        assert complaint in said
        assert said.count("\n") == 1
    assert page(capsys, "--port", tmp_path / "none")[0] == 3


def test_boards_on_usb_are_named_and_not_opened(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    board = ListPortInfo("/dev/ttyACM7")
    board.vid, board.pid = 0x2341, 0x0042
    monkeypatch.setattr(commands_page, "serial_ports", lambda: [board])
    commands_page._tell_of_boards()
    said = capsys.readouterr().err
    assert said == (
        "tilenca: these tiles are emulated; to watch those on USB: tilenca page --port /dev/ttyACM7\n"
    )
    monkeypatch.setattr(commands_page, "serial_ports", list)
    commands_page._tell_of_boards()
    assert capsys.readouterr().err == ""


def test_a_recording_is_one_file_or_served(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record, out = tmp_path / "run.jsonl", tmp_path / "run.html"
    lines = '{"time": 0, "stream": 1, "source": "emulated"}\n{"time": 0, "run": {"seed": 1, "tiles": 0}}\n'
    record.write_text(lines)
    assert cli.main(["page", "--replay", str(record), "--html", str(out)]) == 0
    assert capsys.readouterr().out == f"{out}\n"
    assert '"stream": 1' in out.read_text()
    assert cli.main(["page", "--replay", str(record), "--html", str(tmp_path / "no" / "run.html")]) == 1
    with page_server(None, ["--replay", str(record)]) as server:
        assert 'content="recording"' in get(server.address, "/").read().decode()
        assert get(server.address, "/recording.jsonl").read().decode() == lines
        assert get(server.address, "/alone.html").status == 200
    with page_server(None, ["--replay", str(record)], listen="0.0.0.0:0") as server:
        address = ("127.0.0.1", server.address[1])
        assert get(address, "/recording.jsonl").status == 403
        token = server.url.rpartition("=")[2]
        assert get(address, f"/recording.jsonl?token={token}").status == 200
