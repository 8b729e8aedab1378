"""What failed is remembered until it is flashed."""

import subprocess
import sys
import threading
from pathlib import Path

import pytest

from tilenca.fleet.flash_state import failed_boards, remember

LIMIT_S = 60


def test_where_there_is_no_room_what_failed_before_is_still_known(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    remember({"port:1": False})
    program = (
        "import resource; from tilenca.fleet.flash_state import remember; "
        "resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)); remember({'port:2': False})"
    )
    subprocess.run([sys.executable, "-c", program], timeout=LIMIT_S, check=True)
    assert failed_boards() == {"port:1"}


def test_calls_that_end_at_the_same_moment_forget_nothing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    names = [f"port:{number}" for number in range(40)]
    threads = [threading.Thread(target=remember, args=({name: False},)) for name in names]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failed_boards() == set(names)
    (tmp_path / "tilenca" / "failed.json").write_bytes(b"\xff")
    remember({"port:1": False, "port:2": True})
    assert failed_boards() == {"port:1"}
