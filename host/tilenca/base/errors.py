"""The failures a user can cause or meet, each with the exit status of the command that met it.

A message is one line: the fault, the place and the remedy. `tilenca.cli` prints it on stderr without a
traceback; so it does with refusals of the system (a full disk, no memory). Every other exception is a defect
of this program.
"""

from tilenca.base import paths


class TilencaError(Exception):
    """Something checked or handled failed (exit status 1)."""

    exit_status = 1


class UsageError(TilencaError):
    """Arguments or input files cannot be used as they are (exit status 2)."""

    exit_status = 2


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
