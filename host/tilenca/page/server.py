"""The web server of the page: the static bundle, and a WebSocket for each client with a run of its own."""

import asyncio
import json
import socket
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import BaseRoute, Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp
from starlette.websockets import WebSocket, WebSocketDisconnect, WebSocketState

from tilenca.page.alone import BEHIND, page_alone
from tilenca.page.guard import Guard, GuardedApp
from tilenca.page.joined import joined
from tilenca.page.outbox import Outbox
from tilenca.page.session import Session, Source
from tilenca.protocol.stream import StreamEvent, refused_event
from tilenca.protocol.stream_commands import MAX_TEXT, Seen, parse_command

MOST_CLIENTS = 4
# The modules that the documents name; each is served with all that it imports in it.
ENTRIES = ("main.js", "compare.js")
# Bytes; a character takes at most four.
MAX_MESSAGE = 4 * MAX_TEXT
POLICY_VIOLATION, INTERNAL_ERROR, TRY_AGAIN_LATER = 1008, 1011, 1013
GOODBYE_S = 1


class Client:
    """One WebSocket: commands in, batches of events out."""

    def __init__(self, websocket: WebSocket, make_source: Callable[[], Source]) -> None:
        self._websocket = websocket
        self._outbox = Outbox()
        self._news = asyncio.Event()
        self._loop = asyncio.get_running_loop()
        self._is_over = False
        self._session = Session(make_source, self._deliver, self._note_end)

    def _deliver(self, events: list[StreamEvent]) -> None:
        """Takes events in the session's thread."""
        with suppress(RuntimeError):  # the server has ended meanwhile
            self._loop.call_soon_threadsafe(self._post, events)

    def _note_end(self) -> None:
        """Hears in the session's thread that it ends."""
        with suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._end)

    def _end(self) -> None:
        self._is_over = True
        self._news.set()

    def _post(self, events: list[StreamEvent]) -> None:
        self._outbox.put(events)
        self._news.set()

    async def serve(self) -> None:
        """Serves the client until it goes."""
        sending = asyncio.create_task(self._send())
        try:
            while True:
                self._take(await self._websocket.receive_text())
        except (WebSocketDisconnect, KeyError, RuntimeError):  # it has gone, sends no text, or we have closed
            pass
        finally:
            sending.cancel()
            with suppress(asyncio.CancelledError, WebSocketDisconnect, RuntimeError):
                await sending
            await asyncio.to_thread(self._session.close)

    def _take(self, text: str) -> None:
        try:
            command = parse_command(text)
        except ValueError as error:
            self._post([refused_event(0.0, str(error))])
            return
        if isinstance(command, Seen):
            self._outbox.seen(command.batch)
            self._news.set()
        elif not self._session.offer(command):
            self._post([refused_event(0.0, "too many commands at once; wait a moment")])

    async def _send(self) -> None:
        while True:
            await self._news.wait()
            self._news.clear()
            while self._outbox.may_send:
                batch, events = self._outbox.take()
                message = json.dumps({"batch": batch, "events": events}, separators=(",", ":"))
                await self._websocket.send_text(message)
            if self._is_over and self._outbox.is_empty:
                await self._websocket.close(INTERNAL_ERROR)
                return


def make_app(bundle: Path, make_source: Callable[[str], Source], guard: Guard) -> ASGIApp:
    """The application: the files of the bundle, the stream, and the page as one file for a recording.

    Args:
        bundle: folder of the static page.
        make_source: called for each client, in a thread of its own, with the model that it wants, or "".
        guard: who may come.
    """
    clients = 0

    async def stream(websocket: WebSocket) -> None:
        nonlocal clients
        if not guard.knows_token(websocket.query_params.get("token", "")):
            await websocket.accept()  # a browser tells a page the code only of what was accepted
            await websocket.close(POLICY_VIOLATION)
            return
        await websocket.accept()
        if clients >= MOST_CLIENTS:
            refusal = refused_event(0.0, f"{MOST_CLIENTS} pages are open already; close one of them")
            await websocket.send_text(json.dumps({"batch": 0, "events": [refusal]}))
            await websocket.close(TRY_AGAIN_LATER)
            return
        clients += 1
        try:
            wanted = websocket.query_params.get("model", "")
            await Client(websocket, lambda: make_source(wanted)).serve()
        finally:
            clients -= 1
            if websocket.client_state is WebSocketState.CONNECTED:
                with suppress(RuntimeError):
                    await websocket.close(1003)

    return _app(bundle, guard, [WebSocketRoute("/stream", stream)])


def make_replay_app(bundle: Path, recording: str, guard: Guard) -> ASGIApp:
    """The application that shows a recording: the files of the bundle, and the recording.

    Args:
        bundle: folder of the static page.
        recording: of the page; a line of JSON for each event.
        guard: who may come.
    """
    document = (bundle / "index.html").read_text(encoding="utf-8")
    document = document.replace(BEHIND.format("server"), BEHIND.format("recording"))

    async def first(request: Request) -> Response:
        return HTMLResponse(document)

    async def file(request: Request) -> Response:
        if not guard.knows_token(request.query_params.get("token", "")):
            return PlainTextResponse("refused\n", 403)
        return PlainTextResponse(recording, media_type="application/jsonl")

    return _app(
        bundle, guard, [Route("/", first), Route("/index.html", first), Route("/recording.jsonl", file)]
    )


def _app(bundle: Path, guard: Guard, routes: Sequence[BaseRoute]) -> ASGIApp:
    async def alone(request: Request) -> Response:
        return PlainTextResponse(page_alone(bundle))

    async def program(request: Request) -> Response:
        text = joined(bundle, request.url.path.removeprefix("/"))
        return PlainTextResponse(text, media_type="text/javascript")

    made = [Route("/alone.html", alone), *(Route(f"/{entry}", program) for entry in ENTRIES)]
    files = Mount("/", StaticFiles(directory=bundle, html=True))
    return GuardedApp(Starlette(routes=[*routes, *made, files]), guard)


def serve(app: ASGIApp, listener: socket.socket, on_start: Callable[[], None]) -> None:
    """Serves on a listening socket until it is interrupted.

    Args:
        app: of `make_app`.
        listener: bound and listening.
        on_start: called as soon as clients can come.
    """

    class Server(uvicorn.Server):
        async def startup(self, sockets: list[socket.socket] | None = None) -> None:
            await super().startup(sockets)
            on_start()

    config = uvicorn.Config(
        app,
        log_level="error",
        access_log=False,
        lifespan="off",
        ws="wsproto",
        ws_max_size=MAX_MESSAGE,
        ws_per_message_deflate=False,
        server_header=False,
        timeout_graceful_shutdown=GOODBYE_S,
        h11_max_incomplete_event_size=MAX_MESSAGE,
    )
    Server(config).run(sockets=[listener])
