"""Exclusive use of ports: locks between our own commands, and a look at other programs' open files."""

import fcntl
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from tilenca.base.errors import TilencaError
from tilenca.fleet.ports import is_pty

# All must lock in the same place, so TMPDIR does not count.
FOLDER = Path("/tmp/tilenca-locks")


def holders(names: Iterable[str]) -> dict[str, str]:
    """The other programs that have ports open, as far as /proc shows: `screen (pid 123)`.

    The process at the other end of a pseudo-terminal often keeps this end open as well, lest it hang up
    between two users; being the tile, it does not count.
    """
    wanted = {os.path.realpath(name): name for name in names}
    held: dict[str, str] = {}
    for process in Path("/proc").glob("[0-9]*"):
        if int(process.name) == os.getpid():
            continue
        files = set(_open_files(process))
        serves = any(file.endswith("/ptmx") for file in files)
        for device in files & wanted.keys():
            if not (serves and is_pty(device)):
                held.setdefault(wanted[device], f"{_command(process)} (pid {process.name})")
    return held


def _open_files(process: Path) -> Iterator[str]:
    try:
        for entry in (process / "fd").iterdir():
            try:
                yield str(entry.readlink())
            except OSError:
                continue
    except OSError:
        return


def _command(process: Path) -> str:
    try:
        return (process / "comm").read_text().strip()
    except OSError:
        return "a program"


class PortBusyError(Exception):
    """Another program has the port; the message names it."""


@contextmanager
def port_lock(name: str, user: str) -> Iterator[int]:
    """Keeps other tilenca commands off a port while the block runs.

    The lock is on a file of its own: to lock the port one would have to open it, and that resets a Mega. The
    system frees it when the last process that has the yielded descriptor ends, however it ends.

    Args:
        name: the port.
        user: the command's name for others' messages, such as `tilenca monitor`.

    Yields:
        The lock's descriptor, for a child process that must keep the port after us.

    Raises:
        PortBusyError: it is taken.
        TilencaError: the lock cannot be made.
    """
    path = FOLDER / os.path.realpath(name).strip("/").replace("/", "-")
    try:
        descriptor = _open_shared(path)
    except OSError as error:
        raise TilencaError(
            f"{path}: {error.strerror}, but ports are locked there; remove {path.parent}"
        ) from error
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.pread(descriptor, 200, 0).decode("utf-8", "replace")
            raise PortBusyError(holder or "another tilenca command") from None
        with suppress(OSError):  # no room for its name: the lock holds nevertheless
            os.ftruncate(descriptor, 0)
            os.pwrite(descriptor, f"{user} (pid {os.getpid()})".encode(), 0)
        yield descriptor
    finally:
        os.close(descriptor)


def _open_shared(path: Path) -> int:
    """A file that every user may lock, in a folder of such files.

    Without O_CREAT first: Linux refuses it for the files of others in shared folders.
    """
    if not path.parent.exists():
        path.parent.mkdir(exist_ok=True)
        path.parent.chmod(0o1777)  # shared by the users of this machine, like /tmp itself
    flags = os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW
    try:
        return os.open(path, flags)
    except FileNotFoundError:
        descriptor = os.open(path, flags | os.O_CREAT, 0o666)
        os.fchmod(descriptor, 0o666)
        return descriptor
