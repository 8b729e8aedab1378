"""Compiled objects that builds of the firmware in many folders share, for as long as the tests run.

PlatformIO's build cache goes by the content of the sources and by the whole command, so a build gives what it
would without. It is for copies only: PlatformIO empties a build folder when the settings of its project
change, and the checkout's own build has no cache.
"""

import atexit
import os
import shutil
import tempfile

VARIABLE = "TILENCA_TEST_OBJECTS"


def share() -> None:
    """Makes the folder, once; the processes of pytest-xdist inherit its name."""
    if VARIABLE not in os.environ:
        os.environ[VARIABLE] = tempfile.mkdtemp(prefix="tilenca-objects-")
        atexit.register(shutil.rmtree, os.environ[VARIABLE], ignore_errors=True)


def environment() -> dict[str, str]:
    """The variable that makes PlatformIO use them."""
    return {"PLATFORMIO_BUILD_CACHE_DIR": os.environ[VARIABLE]}
