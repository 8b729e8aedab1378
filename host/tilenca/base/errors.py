"""The failures a user can cause or meet, each with the exit status of the command that met it.

A message is one line: the fault, the place and the remedy; that of a file with several mistakes has a line
for each. `tilenca.cli` prints it on stderr without a traceback; so it does with refusals of the system (a
full disk, no memory). Every other exception is a defect of this program.
"""

from collections.abc import Iterator
from contextlib import contextmanager

from tilenca.base import paths

MOST_MISTAKES = 20  # that a message has


class TilencaError(Exception):
    """Something checked or handled failed (exit status 1)."""

    exit_status = 1


class UsageError(TilencaError):
    """Arguments or input files cannot be used as they are (exit status 2)."""

    exit_status = 2


class Mistakes:
    """What is wrong with an input file, gathered so that a person sees all of it at once."""

    def __init__(self) -> None:
        """Knows of no mistake."""
        self._lines: list[str] = []

    def add(self, message: str) -> None:
        """Adds a message, of a line for each mistake."""
        self._lines += message.split("\n")

    @contextmanager
    def gathered(self) -> Iterator[None]:
        """Adds a `UsageError` that ends the block, and goes on behind it."""
        try:
            yield
        except UsageError as error:
            self.add(str(error))

    def refuse(self) -> None:
        """Raises what was gathered, if anything was.

        Raises:
            UsageError: a line for each mistake, the first of them where there are many.
        """
        more = len(self._lines) - MOST_MISTAKES
        if self._lines:
            rest = [f"and {more} more mistakes"] if more > 0 else []
            raise UsageError("\n".join([*self._lines[:MOST_MISTAKES], *rest]))


class NoDeviceError(TilencaError):
    """No tile was found where one was needed (exit status 3)."""

    exit_status = 3


class BuildError(TilencaError):
    """A build, an export or a missing build product (exit status 4)."""

    exit_status = 4


class InterruptedRunError(TilencaError):
    """Ctrl-C, with a message on how to go on (exit status 130)."""

    exit_status = 130


def image_error(message: str) -> TilencaError:
    """The error for a bad image: a failed build for our own image, a usage error for a given one.

    Args:
        message: the whole message, which begins with the image's path.
    """
    ours = {str(elf.parent) for elf in (paths.FIRMWARE_ELF, paths.firmware_elf())}
    return (BuildError if message.startswith(tuple(ours)) else UsageError)(message)
