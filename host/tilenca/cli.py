# PYTHON_ARGCOMPLETE_OK
"""The `tilenca` command: finds the subcommand, runs it, and turns failures into a line and an exit status.

A subcommand is a module with a one-line docstring (its help), `add_arguments(parser)` and `run(args) -> int`.
Only the chosen module is imported, so that commands which need no torch never wait for it.
"""

import argparse
import importlib
import sys
from collections.abc import Sequence
from pathlib import Path

from tilenca import __version__
from tilenca.base import paths
from tilenca.base.errors import TilencaError
from tilenca.base.project import install_remedy
from tilenca.base.signals import acknowledging, ending_like_ctrl_c
from tilenca.base.stdio import check_streams, finish_streams, warn
from tilenca.base.suggest import did_you_mean
from tilenca.commands import completion
from tilenca.commands.arguments import Parser
from tilenca.commands.examples import epilog

COMMANDS: dict[str, tuple[str, str]] = {
    "new": ("tilenca.commands.new", "make a project of your own: shapes, firmware, builds"),
    "make": ("tilenca.commands.make", "from drawings to tiles: check, train, build and emulate"),
    "shapes": ("tilenca.commands.shapes", "draw and check a shape file, and what its classes may become"),
    "train": ("tilenca.commands.train", "train a model on the shapes of a file"),
    "runs": ("tilenca.commands.runs", "list the trainings in a folder, and draw them over each other"),
    "evaluate": ("tilenca.commands.evaluate", "measure how well a model does on shapes"),
    "sweep": ("tilenca.commands.sweep", "measure over every combination of conditions, on many cores"),
    "report": ("tilenca.commands.report", "measure every claim again, as a page with figures"),
    "plot": ("tilenca.commands.plot", "draw how training went, or a film of what tiles show"),
    "simulate": ("tilenca.commands.simulate", "run drawings on the firmware's core, many runs at once"),
    "export": ("tilenca.commands.export", "render a model into the firmware's C++ files"),
    "emulate": ("tilenca.commands.emulate", "run the firmware image on one emulated board per tile"),
    "page": (
        "tilenca.commands.page",
        "show tiles in the browser, where a hand can rearrange them while they run",
    ),
    "devices": ("tilenca.commands.devices", "list the tiles found on USB"),
    "flash": ("tilenca.commands.flash", "build the firmware and program all tiles side by side"),
    "set": ("tilenca.commands.set", "set something in one, some or all tiles"),
    "monitor": ("tilenca.commands.monitor", "watch the telemetry of all tiles"),
}

HELP = "help"
FAILED = 1
INTERRUPTED = 130


def build_parser(command: str | None = None) -> argparse.ArgumentParser:
    """The command line's grammar; only `command`'s own arguments are loaded."""
    parser = Parser(
        prog="tilenca",
        description="Tiles that know which shape they form: train, export, emulate, flash and watch them.",
        epilog="`tilenca help COMMAND` says what a command takes. "
        "Exit status: 0 all well, 1 a check failed, 2 usage, 3 no device, 4 build or export failed, "
        "130 interrupted.",
    )
    parser.add_argument("--version", action="version", version=f"tilenca {__version__}")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, (module, summary) in COMMANDS.items():
        subparser = subparsers.add_parser(
            name,
            help=summary,
            description=f"{summary[0].upper()}{summary[1:]}.",
            epilog=epilog(name),
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        if name == command:
            importlib.import_module(module).add_arguments(subparser)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Runs one command; returns its exit status (see `--help`)."""
    try:
        check_streams()
        try:
            with ending_like_ctrl_c(), acknowledging():
                status = _run(list(sys.argv[1:] if argv is None else argv))
        finally:
            finish_streams()
        return status
    except TilencaError as error:
        for line in str(error).split("\n"):
            warn(f"tilenca: {line}")
        return error.exit_status
    except KeyboardInterrupt:
        warn("tilenca: interrupted")
        return INTERRUPTED
    except ModuleNotFoundError as error:
        if (error.name or "tilenca").partition(".")[0] == "tilenca":
            raise  # a defect of ours
        warn(f"tilenca: {sys.executable} has no module '{error.name}'; first: {_activation()}")
        return FAILED
    except BrokenPipeError:
        return FAILED  # The reader of our output (head, less) went away before the work was done.
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        warn(f"tilenca: {where}{error.strerror or error}")
        return FAILED
    except MemoryError:
        warn("tilenca: out of memory; close other programs, or give it less to do")
        return FAILED


def _activation() -> str:
    """What gives this Python the modules: another Python that has them, or if it is that one, its setup."""
    if paths.CHECKOUT is None:
        return install_remedy()
    environment = paths.CHECKOUT / ".venv"
    activate = environment / "bin" / "activate"
    if activate.exists() and Path(sys.prefix).resolve() != environment.resolve():
        return f". {activate}"
    return f"make -C {paths.CHECKOUT} setup"


def _run(arguments: list[str]) -> int:
    if completion.is_asked():
        completion.complete(build_parser(completion.command_asked()))
    if not arguments:
        build_parser().print_help()
        return 0
    if arguments[0] == HELP:  # `tilenca help` and `tilenca help emulate`
        arguments = [*arguments[1:2], "--help"]
    command = next((word for word in arguments if not word.startswith("-")), None)
    parser = build_parser(command)
    if command is not None and command not in COMMANDS and arguments[0] == command:
        parser.error(f"no command '{command}'{did_you_mean(command, (*COMMANDS, HELP))}")
    args = parser.parse_args(arguments)
    return int(importlib.import_module(COMMANDS[args.command][0]).run(args))


if __name__ == "__main__":
    sys.exit(main())
