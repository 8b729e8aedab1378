"""Standard output and standard error, which may be closed, full, or a pipe whose reader has gone."""

import io
import os
import sys
from contextlib import suppress
from typing import TextIO

from tilenca.base.errors import TilencaError


def warn(message: str) -> None:
    """One line of chatter on stderr; a closed stderr ends no command."""
    try:
        print(message, file=sys.stderr, flush=True)
    except OSError:
        _silence(sys.stderr)


def check_streams() -> None:
    """Checks, before a command starts, that its result has a place to go.

    Raises:
        TilencaError: standard output is closed.
    """
    if sys.stderr is None:  # print() would take stdout instead
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115, PTH123 - for as long as the process lives
    if sys.stdout is None:
        raise TilencaError("standard output is closed; redirect it to a file or to /dev/null")
    # A name with characters that the locale lacks ends no command.
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


def finish_streams() -> None:
    """Flushes both.

    Raises:
        TilencaError: the result could not be written. A reader that has closed the pipe is no error.
    """
    failed = _flush(sys.stdout)
    _flush(sys.stderr)
    if failed is not None and not isinstance(failed, BrokenPipeError):
        raise TilencaError(f"standard output: {failed.strerror}; the result is not complete")


def _flush(stream: TextIO) -> OSError | None:
    try:
        stream.flush()
    except OSError as error:
        _silence(stream)
        return error
    return None


def _silence(stream: TextIO) -> None:
    """Points a stream that cannot be written at /dev/null, where Python can flush it at its end."""
    with suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
