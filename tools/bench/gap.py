"""Emulated tiles beside the simulator, pair by pair: python -m bench.gap [--runs N] [--write FILE].

Every run is done twice, see `bench.pairs`.
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

from bench.pairs import Pairs, drawings_of, image_with, run_pairs
from bench.publish import publish
from tilenca.base import paths
from tilenca.base.errors import TilencaError
from tilenca.commands.arguments import whole
from tilenca.emulator.translator import make

BEGIN, END = "<!-- gap: made by `python -m bench.gap`, do not edit -->", "<!-- /gap -->"
MODELS = ("digits", "digits-drawn")
UPDATES = (5, 8, 10, 12, 15, 20, 30)


def rows(name: str, pairs: Pairs) -> list[str]:
    """The rows of a model."""
    head = f"| `{name}`, {len(pairs.tiles)} runs, emulated |"
    shares = [
        " ".join(f"{np.mean(found <= update):.3f} |" for update in UPDATES)
        for found in (pairs.tiles, pairs.simulator)
    ]
    gaps = " ".join(f"{100 * gap:+.1f} ± {100 * half:.1f} |" for gap, half in map(pairs.gap, UPDATES))
    return [
        f"{head} {shares[0]}  |  |",
        f"| in the simulator | {shares[1]}  |  |",
        f"| gap, points | {gaps} {pairs.same:.2f} | {pairs.near:.2f} |",
    ]


def table(measured: dict[str, Pairs], command: str) -> str:
    """All models in Markdown.

    Args:
        measured: by model.
        command: that measures them again.
    """
    updates = " | ".join(map(str, UPDATES))
    return "\n".join(
        [
            f"| all tiles right from update | {updates} | at the same update | at most one apart |",
            "|---|" + "---|" * (len(UPDATES) + 2),
            *(line for name, pairs in measured.items() for line in rows(name, pairs)),
            "",
            f"`{command}`; the gaps have their 95 % intervals, of pairs of runs.",
        ]
    )


def main() -> int:
    """Prints the table, and writes it if asked to."""
    parser = argparse.ArgumentParser(description="How far the simulator is from emulated tiles.")
    parser.add_argument(
        "--runs", type=whole(1), nargs="+", default=[100], metavar="N",
        help="of all models, or of one after another (default: 100)",
    )  # fmt: skip
    parser.add_argument(
        "--model", nargs="+", default=MODELS, metavar="NAME", help=f"of models/ (default: {' '.join(MODELS)})"
    )
    parser.add_argument("--seed", type=whole(0), default=1, help="of all runs (default: %(default)s)")
    parser.add_argument("--write", type=Path, metavar="F", help="put the table into this document")
    args = parser.parse_args()
    if len(args.runs) not in (1, len(args.model)):
        parser.error(f"argument --runs: one number, or one for each of {len(args.model)} models")
    runs_of_each = args.runs * (len(args.model) // len(args.runs))
    command = f"python -m bench.gap --runs {' '.join(map(str, args.runs))} --seed {args.seed}"
    if tuple(args.model) != MODELS:
        command += f" --model {' '.join(args.model)}"
    measured: dict[str, Pairs] = {}
    try:
        for name, runs in zip(args.model, runs_of_each, strict=True):
            image = image_with(paths.MODELS / name)
            make(image.elf)
            started = time.perf_counter()
            measured[name] = run_pairs(image, drawings_of(image), runs, args.seed, UPDATES[-1] + 1)
            rate = runs / (time.perf_counter() - started)
            print(f"{name}: {rate:.2f} runs a second", file=sys.stderr)
    except TilencaError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1
    publish(table(measured, command), args.write, BEGIN, END)
    return 0


if __name__ == "__main__":
    sys.exit(main())
