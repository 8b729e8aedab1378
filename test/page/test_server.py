"""The server of the page, over real sockets: who is let in, what gets through, and who can hold it up."""

import os
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from support.page_server import PageServer, page_server
from support.web_socket import RefusedError, WebSocketClient, get
from tilenca.base import paths
from tilenca.page.guard import HEADERS
from tilenca.page.joined import joined
from tilenca.page.outbox import MOST_UNSEEN
from tilenca.page.server import ENTRIES, MAX_MESSAGE, MOST_CLIENTS

LIMIT_S = 60
OPEN = {"do": "open", "cells": [[0, 0], [0, 1]], "spread_s": 0}


@pytest.fixture(scope="module")
def server(firmware: Path) -> Iterator[PageServer]:
    with page_server(firmware) as running:
        yield running


@pytest.fixture
def client(server: PageServer) -> Iterator[WebSocketClient]:
    made = WebSocketClient(server.address)
    yield made
    made.close()


def test_the_bundle_is_served_with_its_policy(server: PageServer) -> None:
    answer = get(server.address, "/")
    assert answer.status == 200
    assert answer.read() == (paths.PAGE / "index.html").read_bytes()
    assert "default-src 'none'" in answer.headers["Content-Security-Policy"]
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    for name, kind in (
        ("main.js", "text/javascript"),
        ("styles/base.css", "text/css"),
        ("icon.svg", "image/svg"),
    ):
        assert get(server.address, f"/{name}").headers["Content-Type"].startswith(kind)


def test_a_program_comes_in_one_answer_and_each_module_by_itself(server: PageServer) -> None:
    for entry in ENTRIES:
        assert get(server.address, f"/{entry}").read().decode() == joined(paths.PAGE, entry)
    alone = get(server.address, "/stream/tiles.js").read()
    assert alone == (paths.PAGE / "stream" / "tiles.js").read_bytes()


@pytest.mark.parametrize(
    "path", ["/../pyproject.toml", "/%2e%2e/pyproject.toml", "/..%2fREADME.md", "/none.js"]
)
def test_only_the_bundle_is_served(server: PageServer, path: str) -> None:
    assert get(server.address, path).status == 404


def test_other_hosts_and_origins_are_refused(server: PageServer) -> None:
    for status, name, value in (
        (421, "Host", "evil.example"),
        (403, "Origin", "http://evil.example"),
    ):
        answer = get(server.address, "/", **{name: value})
        assert answer.status == status
        assert {name: answer.headers[name] for name in HEADERS} == HEADERS
    host, port = server.address
    for headers in (
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": f"http://{host}:{port + 1}"},
    ):
        with pytest.raises(RefusedError, match="403"):
            WebSocketClient(server.address, **headers)
    with pytest.raises(RefusedError, match="403"):
        WebSocketClient(server.address, host="evil.example")
    WebSocketClient(server.address, Origin=f"http://{host}:{port}").close()


def test_beyond_this_machine_a_token_is_needed(firmware: Path) -> None:
    with page_server(firmware, listen="0.0.0.0:0") as server:
        found = re.fullmatch(r"http://0\.0\.0\.0:(\d+)/#token=([\w-]{24,})", server.url)
        assert found, server.url
        address = ("127.0.0.1", int(found[1]))
        assert get(address, "/").status == 200  # the page itself has no secret
        for path in ("/stream", "/stream?token=", "/stream?token=guess"):
            stranger = WebSocketClient(address, path)
            assert stranger.wait_until_closed() == 1008
            assert stranger._messages == []
            stranger.close()
        client = WebSocketClient(address, f"/stream?token={found[2]}")
        assert client.watch("stream")["source"] == "emulated"
        client.close()


def test_a_run_is_told(client: WebSocketClient) -> None:
    assert client.watch("stream")["stream"] == 1
    client.send(OPEN)
    assert client.watch("run")["run"]["tiles"] == 2
    assert client.watch("raw")["raw"].startswith("$HELLO,3,")


def test_what_is_wrong_is_refused_and_the_run_goes_on(client: WebSocketClient) -> None:
    client.send(OPEN)
    client.watch("run")
    client.send({"do": "pull", "port": "tile-77"})
    assert client.watch("refused")["refused"] == "no tile tile-77 lies on the board"
    client.send("nonsense")
    assert client.watch("refused")["refused"].startswith("not JSON")
    client.send({"do": "cut", "port": "tile-01", "side": "E"})
    assert client.watch("cable")["cable"] == "cut"


def test_a_client_that_does_not_look_holds_nothing_up_and_gets_the_latest_later(
    client: WebSocketClient,
) -> None:
    client.send({**OPEN, "speed": 1, "until_s": 1.0})
    numbers = []
    for _ in range(MOST_UNSEEN):
        numbers.append(client.batch()["batch"])  # and says nothing
    client._socket.settimeout(1.5)
    with pytest.raises(TimeoutError):
        client.batch()
    assert numbers == list(range(1, MOST_UNSEEN + 1))
    client._socket.settimeout(30)
    client.send({"do": "seen", "batch": MOST_UNSEEN})
    told = client.batch()
    pace = [event for event in told["events"] if "pace" in event]
    assert (len(pace), pace[0]["time"], pace[0]["pace"]["paused"]) == (1, 1.0, True)
    assert len(told["events"]) < 60


def test_a_message_that_is_too_long_ends_its_connection_only(server: PageServer) -> None:
    client = WebSocketClient(server.address)
    client.send("x" * (MAX_MESSAGE + 1))
    assert client.wait_until_closed() == 1009
    client.close()
    other = WebSocketClient(server.address)
    assert other.watch("stream")
    other.send(b"\0\1")
    assert other.wait_until_closed() == 1003
    other.close()


def test_so_many_pages_and_no_more(server: PageServer) -> None:
    clients = [WebSocketClient(server.address) for _ in range(MOST_CLIENTS)]
    for client in clients:
        client.watch("stream")
    one_more = WebSocketClient(server.address)
    assert "close one of them" in one_more.batch()["events"][0]["refused"]
    assert one_more.wait_until_closed() == 1013
    one_more.close()
    for client in clients:
        client.send({"do": "rest", "on": True})
        client.close()
    for _ in range(3000):  # its place is free as soon as its run has ended
        again = WebSocketClient(server.address)
        told = again.batch()["events"][0]
        again.close()
        if "stream" in told:
            return
    pytest.fail("no place became free")


@pytest.mark.parametrize("how", ["Ctrl-C", "the page goes"])
def test_a_build_ends_with_the_page_that_waits_for_it(tmp_path: Path, how: str) -> None:
    """The "pio" here starts a compiler that takes ten minutes, and says both their numbers."""
    folder, told = tmp_path / "mine", tmp_path / "told"
    shutil.copytree(paths.MODELS / "hex", folder, ignore=shutil.ignore_patterns("firmware"))
    os.mkfifo(told)
    (tmp_path / "pio").write_text(f"#!/bin/sh\nsleep 600 & echo $$ $! > {shlex.quote(str(told))}; wait\n")
    (tmp_path / "pio").chmod(0o755)
    # `pio` is looked for beside the interpreter.
    script = "import sys; sys.executable = sys.argv.pop(1); from tilenca.cli import main; sys.exit(main())"
    words = [str(tmp_path / "python"), "page", "--model", str(folder), "--listen", "127.0.0.1:0", "--no-open"]
    serving = subprocess.Popen(
        [sys.executable, "-c", script, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        assert serving.stdout is not None
        client = WebSocketClient(PageServer(serving.stdout.readline().strip(), serving).address)
        assert client.watch("stream")["source"] == "building"
        started = [Path("/proc") / number for number in told.read_text().split()]
        assert all(map(runs, started))
        if how == "the page goes":
            client.close()
            end_s = time.monotonic() + LIMIT_S
            while any(map(runs, started)):
                assert time.monotonic() < end_s, "its build goes on"
                time.sleep(0.05)
        serving.send_signal(signal.SIGINT)
        _, chatter = serving.communicate(timeout=LIMIT_S)
        assert not any(map(runs, started))
        assert "Traceback" not in chatter
        client.close()
    finally:
        serving.kill()
        serving.wait()


def runs(process: Path) -> bool:
    """Whether a process runs; one that has ended may wait for its parent to notice (state Z)."""
    try:
        return (process / "stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_noise_instead_of_http_does_no_harm(server: PageServer) -> None:
    for noise in (b"\0" * 100, b"GET / HTTP/1.1\r\n\r\n", b"GET " + b"/" * 200_000, b"\x16\x03\x01"):
        with socket.create_connection(server.address, 30) as raw:
            raw.sendall(noise)
    assert get(server.address, "/").status == 200


COMMANDS = (
    '{"do":"open","cells":[[0,0]]}',
    '{"do":"step","seconds":0.02}',
    '{"do":"reset","port":"tile-01"}',
    '{"do":"noise","loss":0.5}',
    '{"do":"seen","batch":1}',
    '{"do":"pace","speed":0,"paused":true}',
)
messages = st.one_of(
    st.text(max_size=40),
    st.sampled_from(COMMANDS),
    st.dictionaries(st.sampled_from(["do", "port", "cells", "row"]), st.integers() | st.text(max_size=5)).map(
        str
    ),
)


@given(st.lists(messages, max_size=10))
@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_whatever_is_sent_the_next_good_command_is_obeyed(client: WebSocketClient, sent: list[str]) -> None:
    for message in sent:
        client.send(message)
    client.send({**OPEN, "seed": 4711})
    for _ in range(100):
        if client.watch("run")["run"]["seed"] == 4711:
            return
    pytest.fail("the run did not begin")
