"""The journal of a sweep: every finished block as a line, so that nothing measured is lost.

The first line says which sweep it is. Each line ends with the CRC-32 of what is before it: what a crash cut
off or the disk damaged is known, and measured again.
"""

import fcntl
import json
import os
import zlib
from pathlib import Path
from typing import IO, Any

from tilenca.base.errors import TilencaError, UsageError
from tilenca.base.stdio import warn
from tilenca.sweep.counts import Counts

FILE = "journal.jsonl"
FORMAT = 1


class Journal:
    """The journal in a folder; one process at a time has it open.

    Args:
        folder: of the sweep; it is made.
        identity: plain values that decide the results.
        command: that makes this sweep, for messages.

    Attributes:
        counts: the results so far, by the blocks' keys.

    Raises:
        UsageError: the folder cannot be written, holds another sweep, or another process writes there.
    """

    def __init__(self, folder: Path, identity: dict[str, Any], command: str) -> None:
        self.path = folder / FILE
        self.counts: dict[str, Counts] = {}
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file: IO[bytes] = self.path.open("a+b")
        except OSError as error:
            raise UsageError(f"{folder}: {error.strerror}; give another --out") from error
        try:
            try:
                fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                raise UsageError(f"{folder}: another sweep is writing there; give another --out") from error
            self._read(identity)
            if self._file.tell() == 0:
                self._write({"format": FORMAT, "command": command, "identity": identity})
        except BaseException:
            self._file.close()
            raise

    def _read(self, identity: dict[str, Any]) -> None:
        self._file.seek(0)
        data = self._file.read()
        whole = data.rfind(b"\n") + 1
        lines = data[:whole].splitlines()
        about = _value_of(lines[0]) if lines else None
        if lines and (about is None or about.get("format") != FORMAT):
            raise UsageError(f"{self.path}: its first line is damaged; remove it, or give another --out")
        if about is not None:
            _compare(self.path.parent, about, json.loads(json.dumps(identity)))
        damaged = 0
        for line in lines[1:]:
            value = _value_of(line)
            if value is None:
                damaged += 1
            else:
                self.counts |= {key: Counts.from_json(counts) for key, counts in value.items()}
        if damaged:
            warn(f"{self.path}: {damaged} damaged lines; what they had is measured again")
        self._file.truncate(whole)  # a line that a crash cut off
        self._file.seek(0, os.SEEK_END)

    def add(self, counts: dict[str, Counts]) -> None:
        """Keeps results; once it returns, they outlast this process.

        Raises:
            TilencaError: the disk is full.
        """
        self._write({key: value.as_json() for key, value in counts.items()})
        self.counts |= counts

    def _write(self, value: dict[str, Any]) -> None:
        text = json.dumps(value, separators=(",", ":"))
        try:
            self._file.write(f"{text} {zlib.crc32(text.encode()):08x}\n".encode())
            self._file.flush()
        except OSError as error:
            raise TilencaError(
                f"{self.path}: {error.strerror}; make room there, and run the same again"
            ) from error

    def close(self) -> None:
        """Ends writing; the lines are on the disk."""
        try:
            os.fsync(self._file.fileno())
        finally:
            self._file.close()


def _value_of(line: bytes) -> dict[str, Any] | None:
    """The value of a line; None: it is damaged."""
    text, _, check = line.rpartition(b" ")
    if f"{zlib.crc32(text):08x}".encode() != check:
        return None
    value = json.loads(text)
    return value if isinstance(value, dict) else None


def _compare(folder: Path, about: dict[str, Any], identity: dict[str, Any]) -> None:
    theirs = about["identity"]
    for name in sorted(identity.keys() | theirs.keys()):
        if identity.get(name) != theirs.get(name):
            raise UsageError(
                f"{folder}: holds a sweep with another {name}; give another --out, or go on with it by: "
                f"{about['command']}"
            )
