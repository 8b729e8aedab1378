"""`tilenca page`: tiles in the browser, running, with a hand that can pull one out."""

import argparse
import contextlib
import os
import socket
import threading
import webbrowser
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.base.project import build_remedy, firmware_image, install_remedy
from tilenca.base.shipped import shapes_file, shapes_names
from tilenca.base.stdio import warn
from tilenca.commands.arguments import existing_image
from tilenca.emulator.greeting import firmware_settings
from tilenca.page.offer import DEFAULT_SHAPES, load_offer

DEFAULT_PORT = 8137
DEFAULT_HOST = "127.0.0.1"
NEEDED = ("starlette", "uvicorn", "wsproto")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add = parser.add_argument
    add(
        "--shapes",
        type=shapes_file,
        action="append",
        metavar="F",
        help="offer the drawings of this shape file, or of one of: "
        f"{' '.join(shapes_names())}; again for more ({' '.join(DEFAULT_SHAPES)})",
    )
    add("--elf", type=Path, metavar="F", help="firmware image (the last build's, or the one of the package)")
    add(
        "--listen",
        type=address,
        metavar="HOST:PORT",
        help=f"where to serve it ({DEFAULT_HOST}:{DEFAULT_PORT}, or any free port if that is taken); "
        "beyond this machine, the address that is printed has a token",
    )
    add(
        "--no-open",
        action="store_true",
        help="print the address only, and open no browser",
    )


def address(text: str) -> tuple[str, int]:
    """The type of HOST:PORT; port 0 is any that is free."""
    host, colon, port = text.rpartition(":")
    if not colon or not host or not port.isdecimal() or int(port) > 65535:
        raise argparse.ArgumentTypeError(f"'{text}' is not HOST:PORT, such as {DEFAULT_HOST}:{DEFAULT_PORT}")
    return host.removeprefix("[").removesuffix("]"), int(port)


def run(args: argparse.Namespace) -> int:
    """Serves the page until Ctrl-C."""
    try:
        from tilenca.page.emulated import EmulatedSource
        from tilenca.page.guard import Guard, is_loopback, new_token
        from tilenca.page.server import make_app, serve
    except ModuleNotFoundError as error:
        if error.name not in NEEDED:
            raise
        raise UsageError(f"the page needs {error.name}; run: {install_remedy('page')}") from error
    offer = load_offer(args.shapes or ())
    image = args.elf or firmware_image()
    existing_image(image, f"{build_remedy()}, or give --elf")
    defaults = firmware_settings(image)
    host, port = args.listen or (DEFAULT_HOST, DEFAULT_PORT)
    with contextlib.closing(_listen(host, port, any_port=args.listen is None)) as listener:
        guard = Guard(host, None if is_loopback(host) else new_token())
        name = f"[{host}]" if ":" in host else host
        url = f"http://{name}:{listener.getsockname()[1]}/"
        if guard.token:
            url += f"#token={guard.token}"

        def make_source() -> EmulatedSource:
            return EmulatedSource(image, defaults, offer.labels, offer.drawings)

        def tell() -> None:
            print(url, flush=True)
            warn("tilenca: the page runs until Ctrl-C")
            if not args.no_open:
                _open_browser(url)

        serve(make_app(paths.PAGE, make_source, guard), listener, tell)
    return 0


def _listen(host: str, port: int, any_port: bool) -> socket.socket:
    """A socket that listens there; with `any_port`, at another port if that one is taken.

    Raises:
        UsageError: it cannot.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, port), family=family)
    except OSError as error:
        if any_port:
            return socket.create_server((host, 0), family=family)
        fact = os.strerror(error.errno) if error.errno and error.errno > 0 else str(error)
        raise UsageError(f"--listen {host}:{port}: {fact}; give another, such as {DEFAULT_HOST}:0") from error


def _open_browser(url: str) -> None:
    """Opens the user's browser, if there is a screen."""
    if any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")):
        threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()
    else:
        warn("tilenca: no screen here to open a browser on; open the address yourself")
