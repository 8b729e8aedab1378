"""Locks on ports: who has one, for how long, and where they cannot be kept."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tilenca.base.errors import TilencaError
from tilenca.fleet import lock
from tilenca.fleet.lock import PortBusyError, holders, port_lock


def test_a_lock_names_its_holder_and_ends_with_its_block(pty: str) -> None:
    holder = rf"^tilenca flash \(pid {os.getpid()}\)$"
    with port_lock(pty, "tilenca flash"), pytest.raises(PortBusyError, match=holder), port_lock(pty, "other"):
        pass
    with port_lock(pty, "other"):
        pass


def test_a_lock_holds_for_users_with_another_folder_for_temporary_files(
    pty: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with port_lock(pty, "us"):
        monkeypatch.setenv("TMPDIR", str(tmp_path))
        with pytest.raises(PortBusyError, match="us"), port_lock(pty, "other"):
            pass


def test_a_child_keeps_the_lock_it_was_given_until_it_ends(pty: str) -> None:
    with port_lock(pty, "tilenca flash") as descriptor:
        child = subprocess.Popen(
            [sys.executable, "-c", "input()"], stdin=subprocess.PIPE, pass_fds=[descriptor]
        )
    try:
        with pytest.raises(PortBusyError), port_lock(pty, "other"):
            pass
    finally:
        child.communicate(b"\n", timeout=60)
    with port_lock(pty, "other"):
        pass


def test_a_program_that_has_the_port_open_is_named(pty: str) -> None:
    program = f"open({pty!r}).fileno(); f = open({pty!r}); print(flush=True); input()"
    with subprocess.Popen(
        [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as child:
        assert child.stdout is not None
        child.stdout.readline()
        held = holders([pty])
        child.communicate(b"\n", timeout=60)
    assert held[pty].endswith(f"(pid {child.pid})")
    assert holders([pty]) == {}, "neither this process nor a dead one holds it"


def test_a_lock_holds_even_where_there_is_no_room_for_a_name(pty: str) -> None:
    program = (
        "import resource, sys; from tilenca.fleet.lock import port_lock; "
        "resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)); lock = port_lock(sys.argv[1], 'us'); "
        "lock.__enter__(); print(flush=True); input()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", program, pty], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as child:
        assert child.stdout is not None
        child.stdout.readline()
        with pytest.raises(PortBusyError, match=r"^another tilenca command$"), port_lock(pty, "other"):
            pass
        child.communicate(b"\n", timeout=60)


def test_locks_that_cannot_be_kept_are_told(
    pty: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "tilenca-locks").write_text("a file of somebody's")
    monkeypatch.setattr(lock, "FOLDER", tmp_path / "tilenca-locks")
    with pytest.raises(TilencaError, match=r"tilenca-locks.*Not a directory.*remove"), port_lock(pty, "us"):
        pass
