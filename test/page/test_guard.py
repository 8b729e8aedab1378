"""Who may come: this machine, our own page, and whoever has the token."""

import pytest
from starlette.datastructures import Headers

from tilenca.page.guard import POLICY, Guard, is_loopback, new_token

LOCAL = Guard("127.0.0.1")
OPEN = Guard("0.0.0.0", "secret")


@pytest.mark.parametrize(
    ("host", "loopback"),
    [("localhost", True), ("127.0.0.1", True), ("127.8.8.8", True), ("::1", True), ("0.0.0.0", False),
     ("::", False), ("192.168.1.5", False), ("example.com", False)],
)  # fmt: skip
def test_loopback_is_this_machine_only(host: str, loopback: bool) -> None:
    assert is_loopback(host) is loopback


@pytest.mark.parametrize(
    ("host", "known"),
    [("127.0.0.1:8137", True), ("localhost:8137", True), ("localhost", True), ("[::1]:8137", True),
     ("LOCALHOST:1", True), ("evil.example:8137", False), ("127.0.0.1.evil.example", False),
     ("evil@127.0.0.1.example", False), ("", False), ("[::1", False), ("localhost.evil", False)],
)  # fmt: skip
def test_another_name_that_leads_here_is_refused(host: str, known: bool) -> None:
    assert LOCAL.knows_host(Headers({"host": host})) is known
    assert OPEN.knows_host(Headers({"host": host}))  # the token decides there


@pytest.mark.parametrize(
    ("origin", "known"),
    [("http://127.0.0.1:8137", True), ("http://127.0.0.1:8138", False), ("http://localhost:8137", False),
     ("http://evil.example", False), ("null", False), ("", False), ("file://", False), ("http://[::1", False),
     ("chrome-extension://127.0.0.1:8137", False)],
)  # fmt: skip
def test_only_our_own_page_may_come_from_a_browser(origin: str, known: bool) -> None:
    headers = Headers({"host": "127.0.0.1:8137", "origin": origin})
    assert LOCAL.knows_origin(headers) is known
    assert OPEN.knows_origin(headers) is known


def test_a_program_that_is_no_browser_has_no_origin() -> None:
    assert LOCAL.knows_origin(Headers({"host": "127.0.0.1:8137"}))


def test_the_token_is_needed_beyond_this_machine() -> None:
    assert LOCAL.knows_token("")
    assert OPEN.knows_token("secret")
    assert not OPEN.knows_token("")
    assert not OPEN.knows_token("secre")
    assert not OPEN.knows_token("s\xe9cret")


def test_tokens_are_long_and_never_the_same() -> None:
    tokens = {new_token() for _ in range(50)}
    assert len(tokens) == 50
    assert min(map(len, tokens)) >= 24


def test_the_policy_lets_nothing_in_from_elsewhere() -> None:
    assert "default-src 'none'" in POLICY
    assert "unsafe" not in POLICY
    assert "*" not in POLICY
    assert "http" not in POLICY
