"""Runs the page of web/bench in a headless Chromium, and measures the processor time of all its processes."""

import json
import os
import shutil
import subprocess
import tempfile
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import quote

from tilenca.base.paths import ROOT

OTHER = "TILENCA_BROWSER"  # names another browser than the system's
NAMES = ("chromium", "chromium-browser", "google-chrome")
PATIENCE_S = 120
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


def program() -> str | None:
    """A Chromium, or None."""
    return os.environ.get(OTHER) or next(filter(None, map(shutil.which, NAMES)), None)


def processor_s(root: int) -> float:
    """Processor seconds of a process and all its descendants so far; those that have ended count, too."""
    spent: dict[int, float] = {}
    children: dict[int, list[int]] = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:  # it has just ended
                continue
            spent[int(entry.name)] = sum(map(int, fields[11:15])) / TICKS_PER_S
            children.setdefault(int(fields[1]), []).append(int(entry.name))
    total, waiting = 0.0, [root]
    while waiting:
        process = waiting.pop()
        total += spent.get(process, 0.0)
        waiting += children.get(process, [])
    return total


class _Run:
    """One page that is open: it says when its measured part begins and ends."""

    def __init__(self) -> None:
        self.ended = threading.Event()
        self.process: subprocess.Popen[bytes] | None = None
        self.begun_s = self.cpu_s = 0.0
        self.told: dict[str, Any] = {}


class _Handler(SimpleHTTPRequestHandler):
    """Serves the page and the bundle, and takes what the page tells."""

    extensions_map = {**SimpleHTTPRequestHandler.extensions_map, ".wasm": "application/wasm"}  # noqa: RUF012

    def __init__(self, run: _Run, bundle: Path, *arguments: Any) -> None:
        self._run, self._bundle = run, bundle
        super().__init__(*arguments, directory=str(ROOT / "web" / "bench"))

    def translate_path(self, path: str) -> str:
        """Files of the bundle, or of the bench."""
        name = path.partition("?")[0]
        if name.startswith("/bundle/"):
            return str(self._bundle / Path(name).name)
        return super().translate_path(path)

    def do_POST(self) -> None:
        """The page begins, or ends."""
        content = self.rfile.read(int(self.headers["Content-Length"]))
        assert self._run.process is not None
        now_s = processor_s(self._run.process.pid)
        if self.path == "/begin":
            self._run.begun_s = now_s
        else:
            self._run.cpu_s = now_s - self._run.begun_s
            self._run.told = json.loads(content)
            self._run.ended.set()
        self.send_response(204)
        self.end_headers()

    def log_message(self, *_arguments: Any) -> None:
        """Says nothing."""


def measure(chromium: str, bundle: Path, case: dict[str, Any]) -> dict[str, float]:
    """Opens the page once: {"cpuS", "wallS"} of what it measures.

    Raises:
        RuntimeError: the page failed, or did not end in time.
    """
    run = _Run()
    with (
        tempfile.TemporaryDirectory() as profile,
        ThreadingHTTPServer(("127.0.0.1", 0), partial(_Handler, run, bundle)) as server,
    ):
        threading.Thread(target=server.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{server.server_port}/index.html#{quote(json.dumps(case))}"
        options = ["--headless=new", "--disable-gpu", "--no-first-run", f"--user-data-dir={profile}"]
        if os.geteuid() == 0:
            options.append("--no-sandbox")  # Chromium's sandbox refuses root
        run.process = subprocess.Popen(
            [chromium, *options, address],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            ended = run.ended.wait(PATIENCE_S)
        finally:
            run.process.terminate()
            run.process.wait(PATIENCE_S)
            server.shutdown()
    if not ended or "error" in run.told:
        raise RuntimeError(f"Chromium: {run.told.get('error', f'no answer in {PATIENCE_S} s')}")
    return {"cpuS": run.cpu_s, "wallS": run.told["wallS"]}
