"""Who may talk to the page's server: the page itself, from this machine, or whoever has the token."""

import ipaddress
import secrets
from dataclasses import dataclass
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

# The page loads nothing from elsewhere, and nobody else may show it in a frame or run code in it.
# Only its own page that compares two runs has frames.
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; font-src 'self'; "
    "connect-src 'self'; manifest-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'self'"
)
HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-cache",
}
LOCAL_NAMES = ("localhost", "127.0.0.1", "::1")


def is_loopback(host: str) -> bool:
    """Whether a name or address means this machine only."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def new_token() -> str:
    """A secret for those who may come from elsewhere."""
    return secrets.token_urlsafe(18)


@dataclass(frozen=True)
class Guard:
    """The rule for one server.

    Attributes:
        host: that it listens at.
        token: what a client from elsewhere must show; None: only this machine can reach it.
    """

    host: str
    token: str | None = None

    def knows_host(self, headers: Headers) -> bool:
        """Whether the request is for us: another site's name that leads here (DNS rebinding) is not."""
        name = _name(headers.get("host", ""))
        return self.token is not None or name in (*LOCAL_NAMES, self.host)

    def knows_origin(self, headers: Headers) -> bool:
        """Whether the request comes from our own page; a program that is no browser sends no origin."""
        origin = headers.get("origin")
        if origin is None:
            return True
        try:
            return urlsplit(origin).scheme in ("http", "https") and urlsplit(origin).netloc == headers.get(
                "host"
            )
        except ValueError:
            return False

    def knows_token(self, given: str) -> bool:
        """Whether it is the token, or none is needed."""
        return self.token is None or secrets.compare_digest(given.encode(), self.token.encode())


def _name(host: str) -> str:
    """The name in a Host header, without the port."""
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""


class GuardedApp:
    """Refuses requests for other hosts and from other origins, and adds the headers of every answer."""

    def __init__(self, app: ASGIApp, guard: Guard) -> None:
        self._app, self._guard = app, guard

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes the request on, or answers it with 403 (421 if it is for another host)."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        status = 0
        if not self._guard.knows_host(headers):
            status = 421
        elif not self._guard.knows_origin(headers):
            status = 403
        if status and scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
        elif status:
            await PlainTextResponse("refused\n", status)(scope, receive, _with_headers(send))
        else:
            await self._app(scope, receive, _with_headers(send))


def _with_headers(send: Send) -> Send:
    async def send_more(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in HEADERS.items():
                headers[name] = value
        await send(message)

    return send_more
