"""Arguments of `tilenca make`, completed as the command does."""

import argparse
from pathlib import Path

from tilenca.commands import make


def asked(shapes: Path, out: Path, *more: str) -> argparse.Namespace:
    """The arguments of a training like that of `trained_model`."""
    words = [str(shapes), "--out", str(out), "--recipe", "smoke", "--hidden", "12", "--seed", "5", *more]
    args = make._parsed(make, words)
    make._complete(args)
    return args
