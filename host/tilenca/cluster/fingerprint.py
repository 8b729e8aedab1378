"""What must be the same in every process that takes part, so that the same seeds give the same bytes."""

import hashlib
from dataclasses import asdict, dataclass
from functools import cache

import numpy as np

from tilenca import __version__
from tilenca.base import paths


@dataclass(frozen=True)
class Fingerprint:
    """The software of one process.

    Attributes:
        tilenca: its version.
        code: SHA-256 of the package's Python files, shortened; a version under development has many.
        numpy: its version; it draws the random numbers.
    """

    tilenca: str
    code: str
    numpy: str

    def differences(self, other: "Fingerprint") -> str:
        """What the other one has instead, in words; empty where they are the same."""
        ours, theirs = asdict(self), asdict(other)
        return ", ".join(
            f"{name} {theirs[name]} instead of {ours[name]}" for name in ours if ours[name] != theirs[name]
        )


@cache
def fingerprint() -> Fingerprint:
    """The fingerprint of this process."""
    digest = hashlib.sha256()
    for path in sorted(paths.PACKAGE.rglob("*.py")):
        data = path.read_bytes()
        digest.update(f"{path.relative_to(paths.PACKAGE)} {len(data)} ".encode() + data)
    return Fingerprint(__version__, digest.hexdigest()[:12], np.__version__)
