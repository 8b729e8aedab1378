"""What all tests share."""

import os
import signal
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, settings

from support import objects
from support.avr import arduino, arduino_core, avr, talk
from support.firmware import firmware
from support.order import rank
from support.terminal import pty

if TYPE_CHECKING:
    from playwright.sync_api import Browser

__all__ = ["arduino", "arduino_core", "avr", "firmware", "pty", "talk"]  # fixtures for every room


# How long an example takes says how busy the machine is, not whether it is right.
settings.register_profile("any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("any machine")


def pytest_configure() -> None:
    """Lets Ctrl-C, and the tests' own, reach the programs under test.

    A shell starts background jobs with these signals ignored, and programs pass that on to their children.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    # Without this limit, idle threads of PyTorch take the processors from other tests: ten times the work.
    workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    os.environ.setdefault("OMP_NUM_THREADS", str(max(1, (os.cpu_count() or 1) // workers)))
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    # Programs go by the terminals that tests give them; the processes of pytest-xdist inherit another size.
    for name in ("COLUMNS", "LINES"):
        os.environ.pop(name, None)
    # What commands keep for their user is not to mix with what this user has.
    os.environ["XDG_STATE_HOME"] = tempfile.mkdtemp(prefix="tilenca-state-")
    objects.share()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Puts files with long tests first; all others keep their order."""
    items.sort(key=lambda item: rank(item.path))


@pytest.fixture(scope="session")
def browser() -> Iterator["Browser"]:
    """One for all tests of a process: Playwright refuses a second one beside it."""
    from support.browser import running_browser  # imports Playwright, which most tests do without

    with running_browser() as running:
        yield running


@pytest.fixture(scope="session")
def two_shapes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A shape file that is trained in seconds."""
    path = tmp_path_factory.mktemp("shapes") / "two.toml"
    path.write_text(
        '[[shape]]\nlabel = "1"\ngrid = """\n#\n#\n#\n"""\n'
        '[[shape]]\nlabel = "7"\ngrid = """\n##\n.#\n.#\n"""\n'
    )
    return path


@pytest.fixture(scope="session")
def trained_model(two_shapes: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model trained on them with seed 5, not interrupted."""
    from support.training import train  # imports torch, which most tests do without

    out = tmp_path_factory.mktemp("models") / "model"
    assert train(two_shapes, out) == 0
    return out
