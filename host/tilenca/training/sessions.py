"""When a model was trained and for how long: the file `sessions.json` beside it. No torch here.

Everything else that a training writes is the same to the byte for the same seed; times are not, so they have
a file of their own.
"""

import json
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from tilenca.base.errors import TilencaError
from tilenca.base.parsing import read_json
from tilenca.base.whole_file import write_whole

FILE = "sessions.json"
STARTED = 19  # of the fields that follow the name in /proc/PID/stat


@dataclass(frozen=True)
class Session:
    """One call of a command that trained.

    Attributes:
        began: when, in UTC, as ISO 8601.
        command: that makes the model.
        recipe: its name.
        seconds: how long it took; None: it has not ended, or was killed.
        host, pid: of the process.
        started: when the process began, as its machine tells it; None: it does not.

    Raises:
        TypeError: a value is of another type, which a damaged file may hold.
    """

    began: str
    command: str
    recipe: str
    seconds: float | None
    host: str
    pid: int
    started: str | None = None

    def __post_init__(self) -> None:
        texts = (self.began, self.command, self.recipe, self.host)
        right = all(isinstance(text, str) for text in texts)
        right &= self.seconds is None or type(self.seconds) in (int, float)
        right &= self.started is None or isinstance(self.started, str)
        if not (right and type(self.pid) is int and self.pid > 0):
            raise TypeError(f"not a session: {self}")

    @property
    def is_running(self) -> bool:
        """Whether it still runs on this machine."""
        if self.seconds is not None or self.host != socket.gethostname():
            return False
        if self.started is not None:
            return self.started == _started(self.pid)
        try:
            os.kill(self.pid, 0)
        except (ProcessLookupError, OverflowError):
            return False
        except PermissionError:
            pass
        return True


def _started(pid: int) -> str | None:
    """When a process began, in its machine's own words: the boot, and the ticks since; None: nobody knows.

    A number alone may be another process's by now, after a reboot above all.
    """
    try:
        boot = Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
        about = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    return f"{boot} {about.rpartition(')')[2].split()[STARTED]}"


def sessions_of(folder: Path) -> list[Session]:
    """The sessions of a model's folder, the first one first; none where nothing is noted or can be read."""
    with suppress(OSError, ValueError, TypeError):
        return [Session(**one) for one in read_json((folder / FILE).read_text(encoding="utf-8"))]
    return []


class Noted:
    """A session that is noted in a model's folder while it lasts; see `noted`."""

    def __init__(self, folder: Path, mine: Session, goes_on: bool) -> None:
        self._folder, self._mine, self._before = folder, mine, sessions_of(folder)
        self._earlier = self._before if goes_on else []
        self._since_s = time.monotonic()
        _write(folder, [*self._earlier, mine])

    @property
    def began(self) -> list[str]:
        """When the sessions of this training began, this one the last."""
        return [session.began for session in (*self._earlier, self._mine)]

    def moved(self, folder: Path) -> None:
        """The model lies in another folder: the one that was there has its own sessions back."""
        if folder != self._folder:
            _write(self._folder, self._before)
            self._folder = folder

    def end(self) -> None:
        """Notes how long it took."""
        ended = replace(self._mine, seconds=round(time.monotonic() - self._since_s, 1))
        _write(self._folder, [*self._earlier, ended])


@contextmanager
def noted(folder: Path, command: str, recipe: str, goes_on: bool) -> Iterator[Noted]:
    """Notes the block as a session of training in this folder, whether it ends well or not.

    Args:
        folder: of the model.
        command: that makes it.
        recipe: its name.
        goes_on: whether earlier sessions count, too.

    Raises:
        TilencaError: the folder cannot be written.
    """
    began = datetime.now(UTC).isoformat(timespec="seconds")
    pid = os.getpid()
    mine = Session(began, command, recipe, None, socket.gethostname(), pid, _started(pid))
    session = Noted(folder, mine, goes_on)
    try:
        yield session
    except BaseException:
        with suppress(TilencaError):  # the first failure is the one to tell
            session.end()
        raise
    session.end()


def _write(folder: Path, sessions: list[Session]) -> None:
    text = json.dumps([asdict(session) for session in sessions], indent=2) + "\n"
    write_whole(folder / FILE, text.encode(), "make room there, or give another --out")
