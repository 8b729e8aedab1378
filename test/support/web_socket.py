"""A WebSocket client that a test drives: it reads when the test says so, and sends what the test likes."""

import http.client
import json
import socket
from typing import Any

from wsproto import ConnectionType, WSConnection
from wsproto.events import (
    AcceptConnection,
    BytesMessage,
    CloseConnection,
    Ping,
    RejectConnection,
    Request,
    TextMessage,
)

LIMIT_S = 30


class RefusedError(Exception):
    """The server did not accept; the status is the first argument."""


class WebSocketClient:
    """A connection to the stream."""

    def __init__(
        self, address: tuple[str, int], path: str = "/stream", host: str | None = None, **headers: str
    ) -> None:
        """Connects.

        Raises:
            RefusedError: the server would not have it.
        """
        self._socket = socket.create_connection(address, LIMIT_S)
        self._connection = WSConnection(ConnectionType.CLIENT)
        extra = [(name.encode(), value.encode()) for name, value in headers.items()]
        host = f"{address[0]}:{address[1]}" if host is None else host
        self._socket.sendall(self._connection.send(Request(host=host, target=path, extra_headers=extra)))
        self._text = ""
        self._messages: list[str] = []
        self.close_code: int | None = None
        self._accepted = False
        while not self._accepted:
            self._receive()

    def _receive(self) -> None:
        data = self._socket.recv(65536)
        self._connection.receive_data(data or None)
        for event in self._connection.events():
            match event:
                case AcceptConnection():
                    self._accepted = True
                case RejectConnection():
                    self._socket.close()
                    raise RefusedError(event.status_code)
                case TextMessage():
                    self._text += event.data
                    if event.message_finished:
                        self._messages.append(self._text)
                        self._text = ""
                case Ping():
                    self._socket.sendall(self._connection.send(event.response()))
                case CloseConnection():
                    self.close_code = int(event.code)

    def send(self, message: str | bytes | dict[str, Any]) -> None:
        """Sends a text, bytes, or an object as JSON."""
        if isinstance(message, bytes):
            self._socket.sendall(self._connection.send(BytesMessage(message)))
        else:
            text = message if isinstance(message, str) else json.dumps(message)
            self._socket.sendall(self._connection.send(TextMessage(text)))

    def batch(self) -> dict[str, Any]:
        """The next batch; it fails if the server closes before."""
        while not self._messages:
            assert self.close_code is None, f"closed with {self.close_code}"
            self._receive()
        told: dict[str, Any] = json.loads(self._messages.pop(0))
        return told

    def watch(self, key: str, batches: int = 2000) -> dict[str, Any]:
        """Reads on, and shows what it reads, until an event has this key; returns the event."""
        for _ in range(batches):
            told = self.batch()
            self.send({"do": "seen", "batch": told["batch"]})
            for event in told["events"]:
                if key in event:
                    found: dict[str, Any] = event
                    return found
        raise AssertionError(f"no {key} in {batches} batches")

    def wait_until_closed(self) -> int:
        """Reads until the server closes; returns the code."""
        while self.close_code is None:
            self._receive()
        return self.close_code

    def close(self) -> None:
        """Goes without a word, as a browser that is killed."""
        self._socket.close()


def get(address: tuple[str, int], path: str, **headers: str) -> http.client.HTTPResponse:
    """The answer to a plain request."""
    connection = http.client.HTTPConnection(*address, timeout=LIMIT_S)
    connection.request("GET", path, headers=headers)
    return connection.getresponse()
