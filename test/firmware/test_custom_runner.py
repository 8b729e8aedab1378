"""PlatformIO's own doctest runner, content with the doctest of the system (Debian: doctest-dev)."""

from pathlib import Path

from platformio.test.runners.doctest import DoctestTestRunner

SYSTEM_HEADER = Path("/usr/include/doctest/doctest.h")


class CustomTestRunner(DoctestTestRunner):  # type: ignore[misc]
    """Fetches doctest from PlatformIO's registry only where the system has none."""

    EXTRA_LIB_DEPS = None if SYSTEM_HEADER.is_file() else DoctestTestRunner.EXTRA_LIB_DEPS
