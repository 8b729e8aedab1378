"""`tilenca page` as a user starts it."""

import argparse
import builtins
import re
import socket
import sys
from pathlib import Path
from typing import Any

import pytest

from support.page_server import page_server
from support.web_socket import WebSocketClient
from tilenca import cli
from tilenca.base import paths
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
