"""What must be the same in every process that takes part, so that the same seeds give the same bytes."""

import hashlib
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

import numpy as np

from tilenca import __version__
from tilenca.base import native_library, paths

ABSENT = ""  # the digest of a library that is not there


@dataclass(frozen=True)
class Fingerprint:
    """The software of one process.

    Attributes:
        tilenca: its version.
        code: SHA-256 of the package's Python files, shortened; a version under development has many.
        numpy: its version; it draws the random numbers.
        simulator: SHA-256 of the compiled library, shortened; `ABSENT` where there is none.
        emulator: the same.
        rollout: the same; only training needs it.
    """

    tilenca: str
    code: str
    numpy: str
    simulator: str
    emulator: str
    rollout: str

    def differences(self, other: "Fingerprint") -> str:
        """What the other one has instead, in words; empty where they are the same.

        A library that one of them lacks is no difference: work that needs it says so by itself.
        """
        ours, theirs = asdict(self), asdict(other)
        return ", ".join(
            f"{name} {theirs[name]} instead of {ours[name]}"
            for name in ours
            if ours[name] != theirs[name] and ABSENT not in (ours[name], theirs[name])
        )


@cache
def fingerprint() -> Fingerprint:
    """The fingerprint of this process."""
    digest = hashlib.sha256()
    for path in sorted(paths.PACKAGE.rglob("*.py")):
        data = path.read_bytes()
        digest.update(f"{path.relative_to(paths.PACKAGE)} {len(data)} ".encode() + data)
    libraries = {name: _digest(native_library.find(name).library) for name in native_library.FOLDERS}
    return Fingerprint(__version__, digest.hexdigest()[:12], np.__version__, **libraries)


def _digest(library: Path) -> str:
    return hashlib.sha256(library.read_bytes()).hexdigest()[:12] if library.is_file() else ABSENT
