"""The failures a user can cause or meet, each with the exit status of the command that met it.

A message is one line: what is wrong, where, and what to do about it. `tilenca.cli` prints it on stderr
without a traceback; every other exception is a defect of this program.
"""


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
