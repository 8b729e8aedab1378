"""The commit that runs, for what is kept of a run."""

import shutil
import subprocess

from tilenca import __version__
from tilenca.base import paths


def commit() -> str:
    """The commit this runs on, `-dirty` when tracked files differ; of an installed wheel, its version."""
    if paths.CHECKOUT is None:
        return f"tilenca {__version__}"
    git = shutil.which("git")
    if git is None:
        return "unknown"
    words = [git, "-C", str(paths.CHECKOUT), "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "unknown"
