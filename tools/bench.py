"""Prints what the firmware costs and how fast it is emulated: python tools/bench.py FIRMWARE.elf."""

import argparse
import json
import subprocess
import sys
from pathlib import Path

import budgets

TILENCA = Path(sys.executable).with_name("tilenca")


def emulation(elf: Path, seconds: float) -> str:
    """How fast the twenty tiles' worth of a full drawing runs, as one line.

    Raises:
        subprocess.CalledProcessError: the emulation failed; it has told why.
    """
    options = ["--elf", str(elf), "--seconds", str(seconds), "--json"]
    command = [str(TILENCA), "emulate", "--shape", "8", *options]
    done = subprocess.run(command, stdout=subprocess.PIPE, check=True)
    result = json.loads(done.stdout)
    ratio = result["simulated_s"] / result["wall_s"]
    return f"{'emulation':<22} {len(result['tiles'])} tiles, {ratio:.1f} times real time on this machine"


def main() -> int:
    """Prints the sizes, then the speed; returns the exit status of the budgets."""
    parser = argparse.ArgumentParser(
        description="Prints what the firmware costs and how fast it is emulated."
    )
    parser.add_argument("elf", type=Path, help="the image, as .pio/build/megaatmega2560/firmware.elf")
    parser.add_argument("--seconds", type=float, default=20.0, help="emulated time (default: %(default)s)")
    args = parser.parse_args()
    status = budgets.report(args.elf)
    print(emulation(args.elf, args.seconds), flush=True)
    return status


if __name__ == "__main__":
    sys.exit(main())
