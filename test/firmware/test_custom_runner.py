"""PlatformIO's own doctest runner, content with the doctest of the system (Debian: doctest-dev)."""

from pathlib import Path

from platformio.test.exception import UnitTestSuiteError
from platformio.test.runners.doctest import DoctestTestRunner

SYSTEM_HEADER = Path("/usr/include/doctest/doctest.h")


class CustomTestRunner(DoctestTestRunner):  # type: ignore[misc]
    """Fetches doctest from PlatformIO's registry only where the system has none."""

    EXTRA_LIB_DEPS = None if SYSTEM_HEADER.is_file() else DoctestTestRunner.EXTRA_LIB_DEPS

    def stage_testing(self) -> None:
        """A program that reports no test case has not passed; PlatformIO alone would call it skipped."""
        super().stage_testing()
        if not self.options.without_testing and not self.test_suite.cases:
            raise UnitTestSuiteError("no test case was reported: does the suite include report.h?")
