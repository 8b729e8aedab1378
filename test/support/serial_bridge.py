"""The page's own server, with serial ports for the browser: a stand-in for Web Serial.

Its ports are pseudo-terminals. Behind them is whatever a test puts there: served emulated tiles with the
stock bootloader, or a board that misbehaves.
"""

import asyncio
import json
import os
import socket
import threading
import tty
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

import uvicorn
from starlette.applications import Starlette
from starlette.routing import Mount, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from tilenca.base import paths
from tilenca.page.guard import Guard
from tilenca.page.offer import load_offer
from tilenca.page.server import make_app
from tilenca.protocol.stream import StreamEvent, run_event, stream_event
from tilenca.protocol.stream_commands import StreamCommand
from tilenca.shapes.glyphs import looks_of

LIMIT_S = 60

# As much of Web Serial as the page uses, over a WebSocket for each port. GRANTED are the ports that the page
# may use already, OFFERED those that a person chooses one after the other.
STAND_IN = """
(() => {
  class Port extends EventTarget {
    constructor(name) {
      super();
      Object.assign(this, { name, socket: null, readable: null, writable: null, connected: true });
    }
    getInfo() {
      return { usbVendorId: 0x2341, usbProductId: serial.kinds[this.name] ?? 0x0042 };
    }
    async open({ baudRate }) {
      if (baudRate !== 115200) throw new TypeError(`${baudRate} baud`);
      if (this.socket) throw new DOMException("The port is already open.", "InvalidStateError");
      const socket = new WebSocket(`ws://${location.host}/port?name=${this.name}`);
      socket.binaryType = "arraybuffer";
      await new Promise((resolve, reject) => {
        socket.onmessage = resolve;
        socket.onclose = () => reject(new DOMException("Failed to open serial port.", "NetworkError"));
      });
      this.socket = socket;
      let reading;
      this.readable = new ReadableStream({ start: (controller) => { reading = controller; } });
      this.writable = new WritableStream({ write: (bytes) => socket.send(bytes) });
      socket.onmessage = ({ data }) => reading.enqueue(new Uint8Array(data));
      socket.onclose = () => {
        if (this.socket !== socket) return;
        this.connected = false;
        this.socket = this.readable = this.writable = null;
        reading.error(new DOMException("The device has been lost.", "NetworkError"));
        this.dispatchEvent(new Event("disconnect"));
      };
    }
    async setSignals(signals) {
      if (!this.socket) throw new DOMException("The port is closed.", "InvalidStateError");
      this.socket.send(JSON.stringify(signals));
    }
    async close() {
      if (this.readable?.locked || this.writable?.locked) throw new TypeError("The streams are locked.");
      const { socket } = this;
      this.socket = this.readable = this.writable = null;
      socket?.close();
    }
  }
  const ports = new Map();
  const port = (name) => {
    if (!ports.has(name)) ports.set(name, new Port(name));
    return ports.get(name);
  };
  const serial = new EventTarget();
  const offered = OFFERED;
  serial.getPorts = async () => GRANTED.map(port);
  serial.requestPort = async () => {
    if (!offered.length) throw new DOMException("No port selected by the user.", "NotFoundError");
    return port(offered.shift());
  };
  serial.kinds = {};
  serial.unplug = (name) => port(name).socket.close();
  serial.plug = (name) => {
    ports.delete(name); // as in Chromium: it is another object
    const event = new Event("connect");
    Object.defineProperty(event, "target", { value: port(name) });
    serial.dispatchEvent(event);
  };
  Object.defineProperty(navigator, "serial", { value: serial });
})();
"""


def stand_in(granted: list[str], offered: list[str]) -> str:
    """The program that gives a document such ports; for `Page.add_init_script`."""
    return STAND_IN.replace("GRANTED", json.dumps(granted)).replace("OFFERED", json.dumps(offered))


@dataclass
class Bridge:
    """Ports by name; what a test does to them holds for what passes from now on.

    Attributes:
        ports: the pseudo-terminal behind each name.
        url: of the page.
        passing: called with the name and the bytes of each message to a board; returns what arrives there, or
            None: the port goes away.
        pulled: names whose port is not there.
        resets: how often the browser has reset each board.
    """

    ports: Mapping[str, Path]
    url: str = ""
    passing: Callable[[str, bytes], bytes | None] = lambda name, data: data
    pulled: set[str] = field(default_factory=set)
    resets: dict[str, int] = field(default_factory=dict)

    async def serve(self, websocket: WebSocket) -> None:
        """One open port."""
        name = websocket.query_params["name"]
        await websocket.accept()
        if name in self.pulled:
            await websocket.close()
            return
        line = _Line(self.ports[name])
        await websocket.send_text("open")
        telling = asyncio.create_task(_tell(line, websocket))
        try:
            while True:
                message = await websocket.receive()
                if message["type"] == "websocket.disconnect":
                    return
                if data := message.get("bytes"):
                    passed = self.passing(name, data)
                    if passed is None:
                        await websocket.close()
                        return
                    line.write(passed)
                elif text := message.get("text"):
                    if json.loads(text)["dataTerminalReady"]:
                        line.open()
                        self.resets[name] = self.resets.get(name, 0) + 1
                    else:
                        line.close()
        except (WebSocketDisconnect, RuntimeError, OSError):
            pass
        finally:
            telling.cancel()
            line.close()


class _Line:
    """A pseudo-terminal; opening it raises DTR."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._loop = asyncio.get_running_loop()
        self.heard: asyncio.Queue[bytes] = asyncio.Queue()
        self._port = -1
        self.open()

    def open(self) -> None:
        if self._port >= 0:
            return
        self._port = os.open(self._path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        tty.setraw(self._port)
        self._loop.add_reader(self._port, self._read)

    def _read(self) -> None:
        try:
            data = os.read(self._port, 4096)
        except BlockingIOError:
            return
        except OSError:  # the board has gone
            data = b""
        if not data:
            self._loop.remove_reader(self._port)
        self.heard.put_nowait(data)

    def write(self, data: bytes) -> None:
        os.write(self._port, data)

    def close(self) -> None:
        if self._port < 0:
            return
        self._loop.remove_reader(self._port)
        os.close(self._port)
        self._port = -1


async def _tell(line: _Line, websocket: WebSocket) -> None:
    with suppress(RuntimeError, WebSocketDisconnect):
        while data := await line.heard.get():
            await websocket.send_bytes(data)
        await websocket.close()


class NoTiles:
    """What stands behind the page at first: the looks of the digits, and nothing that takes time."""

    is_idle = True

    def begin(self) -> list[StreamEvent]:
        looks = [
            {"label": look.label, "segments": look.segments, "rgb": list(look.colour)}
            for look in looks_of(load_offer().labels)
        ]
        run = run_event(0.0, {"seed": 0, "shape": "-", "tiles": 0})
        return [stream_event("watched", looks=looks, takes=["rest", "seen"]), run]

    def take(self, command: StreamCommand) -> None:
        """Does nothing."""

    def advance(self, wall_s: float) -> list[StreamEvent]:
        return []

    def abandon(self) -> None:
        """Nothing takes long."""

    def close(self) -> None:
        """Nothing is open."""


@contextmanager
def bridged_page(ports: Mapping[str, Path]) -> Iterator[Bridge]:
    """Serves the page, as `tilenca page` does, and the ports."""
    app = make_app(paths.PAGE, lambda wanted: NoTiles(), Guard("127.0.0.1"))
    bridge = Bridge(ports)
    whole = Starlette(routes=[WebSocketRoute("/port", bridge.serve), Mount("/", app)])
    with socket.create_server(("127.0.0.1", 0)) as listener:
        bridge.url = f"http://127.0.0.1:{listener.getsockname()[1]}/"
        config = uvicorn.Config(whole, log_level="error", lifespan="off", ws="wsproto")
        server = uvicorn.Server(config)
        thread = threading.Thread(target=server.run, args=([listener],), daemon=True)
        thread.start()
        try:
            yield bridge
        finally:
            server.should_exit = server.force_exit = True
            thread.join(LIMIT_S)
            assert not thread.is_alive(), "the server does not end"
