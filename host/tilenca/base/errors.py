"""The failures a user can cause or meet, each with the exit status of the command that met it.

A message is one line: what is wrong, where, and what to do about it. `tilenca.cli` prints it on stderr
without a traceback, and so it does what the system refuses (a full disk, no memory). All else is a defect of
this program.
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
    """Ctrl-C, and there is more to say than that: how to go on (exit status 130)."""

    exit_status = 130


def image_error(message: str) -> TilencaError:
    """What is wrong with an image: our own build's is a failed build, a given one's is a usage error.

    Args:
        message: the whole message, which begins with the image's path.
    """
    ours = {str(elf.parent) for elf in (paths.FIRMWARE_ELF, paths.firmware_elf())}
    return (BuildError if message.startswith(tuple(ours)) else UsageError)(message)
