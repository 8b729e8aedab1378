"""`tilenca page`: tiles in the browser, running, with a hand that can pull one out."""

import argparse
import contextlib
import os
import socket
import threading
import webbrowser
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from tilenca.base import paths
from tilenca.base.errors import TilencaError, UsageError
from tilenca.base.project import install_remedy
from tilenca.base.shipped import model_folder, shapes_file, shapes_names
from tilenca.base.stdio import warn
from tilenca.base.whole_file import write_whole
from tilenca.commands.arguments import add_fleet_arguments
from tilenca.commands.origin import model_with_id
from tilenca.commands.page_models import page_models
from tilenca.fleet.boards import load_places
from tilenca.fleet.grid import Grid
from tilenca.fleet.listen import Listener
from tilenca.fleet.ports import megas, serial_ports
from tilenca.fleet.recording import Recorder
from tilenca.page.alone import page_alone, with_recording
from tilenca.page.chosen import ChosenSource
from tilenca.page.offer import DEFAULT_SHAPES, load_offer
from tilenca.page.replayed import page_recording

if TYPE_CHECKING:
    from tilenca.page.session import Source

DEFAULT_PORT = 8137
DEFAULT_HOST = "127.0.0.1"
NEEDED = ("starlette", "uvicorn", "wsproto")
USER = "tilenca page"


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
    image = parser.add_mutually_exclusive_group()
    image.add_argument(
        "--model",
        type=model_folder,
        metavar="DIR",
        help="begin with this model; its firmware is built where it is not there yet (that of the firmware)",
    )
    image.add_argument(
        "--elf", type=Path, metavar="F", help="firmware image (the last build's, or the one of the package)"
    )
    add_fleet_arguments(parser, "watches them instead of emulated tiles; none is taken without it")
    add("--record", type=Path, metavar="F", help="with --port: append all received lines to F")
    add("--replay", type=Path, metavar="F", help="show a recording instead, of the page or of --record")
    add(
        "--html",
        type=Path,
        metavar="OUT",
        help="with --replay: write one file that replays it, and serve nothing",
    )
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
        from tilenca.page.guard import Guard, is_loopback, new_token
        from tilenca.page.server import make_app, make_replay_app, serve
    except ModuleNotFoundError as error:
        if error.name not in NEEDED:
            raise
        raise UsageError(f"the page needs {error.name}; run: {install_remedy('page')}") from error
    _check_combinations(args)
    recording = _recording(args) if args.replay else ""
    if args.html:
        document = with_recording(page_alone(paths.PAGE), recording)
        write_whole(args.html, document.encode(), "give --html a file that can be written")
        print(args.html)
        return 0
    with ExitStack() as stack:
        make_source = None if args.replay else _watched(args, stack) if args.port else _emulated(args)
        host, port = args.listen or (DEFAULT_HOST, DEFAULT_PORT)
        listener = stack.enter_context(contextlib.closing(_listen(host, port, args.listen is None)))
        guard = Guard(host, None if is_loopback(host) else new_token())
        name = f"[{host}]" if ":" in host else host
        url = f"http://{name}:{listener.getsockname()[1]}/"
        if guard.token:
            url += f"#token={guard.token}"

        app = (
            make_app(paths.PAGE, make_source, guard)
            if make_source
            else make_replay_app(paths.PAGE, recording, guard)
        )

        def tell() -> None:
            print(url, flush=True)
            warn("tilenca: the page runs until Ctrl-C")
            if not (args.port or args.replay):
                _tell_of_boards()
            if not args.no_open:
                _open_browser(url)

        serve(app, listener, tell)
    return 0


def _check_combinations(args: argparse.Namespace) -> None:
    """Refuses what would be ignored."""
    if args.record and not args.port:
        raise UsageError("--record does nothing without --port; add it, or leave --record out")
    if args.tiles and not (args.port or args.replay):
        raise UsageError("--tiles does nothing without --port; add it, or leave --tiles out")
    if args.html and args.listen:
        raise UsageError("--html writes a file and serves nothing; leave --listen out")
    if args.html and not args.replay:
        raise UsageError("--html does nothing without --replay; add it, or leave --html out")
    if args.replay and (args.port or args.elf or args.model):
        raise UsageError("--replay shows a recording, and no tiles; leave --port, --elf and --model out")
    for option, given in (("elf", args.elf), ("model", args.model)):
        if given and args.port:
            raise UsageError(
                f"--{option} is for emulated tiles, and --port for others; leave one of them out"
            )


def _emulated(args: argparse.Namespace) -> "Callable[[str], Source]":
    """Makes emulated tiles, for each page its own, of the model that it has chosen."""
    models = page_models(args.elf, args.model, args.shapes or ())
    return lambda wanted: ChosenSource(models, wanted)


def _watched(args: argparse.Namespace, stack: ExitStack) -> "Callable[[str], Source]":
    """Watches the tiles behind ports, once for all pages."""
    from tilenca.page.watched import Watch, WatchedSource

    labels = load_offer(args.shapes or ()).labels
    listener = stack.enter_context(Listener(args.port, args.tiles, USER))
    record = stack.enter_context(Recorder(args.record, "a")) if args.record else None
    watch = stack.enter_context(Watch(listener, labels, _labels_of, record))
    return lambda wanted: WatchedSource(watch)


def _recording(args: argparse.Namespace) -> str:
    """The recording, as the page takes it."""
    labels = load_offer(args.shapes or ()).labels
    grid = Grid(load_places(args.tiles), given=args.tiles is not None)
    return page_recording(args.replay, labels, _labels_of, grid)


def _labels_of(model_id: int) -> Sequence[str] | None:
    known = model_with_id(model_id)
    return known[0].labels if known else None


def _tell_of_boards() -> None:
    """Says so where boards are on USB. None is taken without being asked: opening one may reset it."""
    with contextlib.suppress(TilencaError):
        if found := [port.name for port in megas(serial_ports())]:
            words = " ".join(f"--port {name}" for name in found[:3])
            more = f" ({len(found)} boards are on USB)" if len(found) > 3 else ""
            warn(f"tilenca: these tiles are emulated; to watch those on USB{more}: tilenca page {words}")


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
