"""What must be the same on all machines."""

import hashlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from tilenca import __version__
from tilenca.base import native_library
from tilenca.cluster.fingerprint import ABSENT, fingerprint


@pytest.fixture
def libraries(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty folder in the place of the compiled libraries."""
    monkeypatch.setenv(native_library.OTHER_FOLDER, str(tmp_path))
    fingerprint.cache_clear()
    yield tmp_path
    fingerprint.cache_clear()


def test_equal_software_has_no_differences() -> None:
    assert fingerprint().tilenca == __version__
    assert fingerprint().differences(replace(fingerprint())) == ""


def test_differences_name_both_sides() -> None:
    ours = fingerprint()
    theirs = replace(ours, tilenca="0.0.1", numpy="1.0")
    assert (
        ours.differences(theirs)
        == f"tilenca 0.0.1 instead of {__version__}, numpy 1.0 instead of {ours.numpy}"
    )


def test_other_libraries_are_a_difference(libraries: Path) -> None:
    library = libraries / "libtilenca_simulator.so"
    library.write_bytes(b"one compiler's")
    ours = fingerprint()
    assert ours.simulator == hashlib.sha256(b"one compiler's").hexdigest()[:12]
    library.write_bytes(b"another's")
    fingerprint.cache_clear()
    assert (
        ours.differences(fingerprint()) == f"simulator {fingerprint().simulator} instead of {ours.simulator}"
    )


def test_a_library_that_one_lacks_is_no_difference(libraries: Path) -> None:
    without = fingerprint()
    assert (without.simulator, without.emulator, without.rollout) == (ABSENT, ABSENT, ABSENT)
    having = replace(without, rollout="123456789abc")
    assert having.differences(without) == without.differences(having) == ""
