"""The emulator in a browser, beside this machine's own: python -m bench.web [--write FILE].

Twenty tiles of the real firmware in a block. All cases take turns, each in a process of its own; each figure
is the best of a few rounds, in processor time, since other load changes that least.
"""

import argparse
import gzip
import json
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bench import chromium
from bench.figures import exact, note, of_rounds
from bench.publish import publish
from bench.reference import COMMIT, Measured, host_of_reference, native, told
from tilenca.base.errors import BuildError
from tilenca.base.paths import BUILD, FIRMWARE_ELF, ROOT
from tilenca.emulator.translator import make

BUNDLE = BUILD / "web" / "bundle"
EMULATED = ("tilenca_emulator.wasm", "firmware.elf")
BEGIN, END = "<!-- web: made by `python -m bench.web`, do not edit -->", "<!-- /web -->"
ROWS, COLUMNS = 5, 4
# Browsers compile what runs much while it runs; the first second says more about that than about tiles.
WARM_UP_S, MEASURED_S = 1.5, 3.0

Case = dict[str, Any]


def case(translated: bool) -> Case:
    """The block as web/bench/block.js and native_block.py take it."""
    block = {"rows": ROWS, "columns": COLUMNS, "translated": translated}
    return block | {"warmUpS": WARM_UP_S, "measuredS": MEASURED_S}


def node(translated: bool) -> Measured:
    """The bundle under node."""
    script = ROOT / "web" / "bench" / "node.js"
    return told(["node", str(script), str(BUNDLE), json.dumps(case(translated))])


def cases() -> dict[str, Callable[[], Measured]]:
    """What is measured, by its name."""
    host = ROOT / "host"
    found: dict[str, Callable[[], Measured]] = {
        "native": lambda: native(host, case(True)),
        "native, interpreted": lambda: native(host, case(False)),
        "node": lambda: node(True),
        "node, interpreted": lambda: node(False),
    }
    if (browser := chromium.program()) is not None:
        found["Chromium"] = lambda: chromium.measure(browser, BUNDLE, case(True))
        found["Chromium, interpreted"] = lambda: chromium.measure(browser, BUNDLE, case(False))
    if (before := host_of_reference()) is not None:
        found[f"native at {COMMIT}, before blocks were translated"] = lambda: native(before, case(False))
    return found


def size(files: list[Path]) -> str:
    """Bytes of files, raw and gzipped each."""
    contents = [path.read_bytes() for path in files]
    gzipped = sum(len(gzip.compress(content, 9)) for content in contents)
    return f"{sum(map(len, contents)) / 1000:.0f} KB, gzipped {gzipped / 1000:.0f} KB"


def measure(rounds: int) -> list[tuple[str, str]]:
    """Name and figure; one row per figure."""
    found = cases()
    best: dict[str, Measured] = {}
    cpu_s: dict[str, list[float]] = {name: [] for name in found}
    for _ in range(rounds):
        for name, run in found.items():
            told = run()
            cpu_s[name].append(told["cpuS"])
            known = best.setdefault(name, told)
            best[name] = {key: min(value, known[key]) for key, value in told.items()}
    if rounds > 1:
        for name, seconds in cpu_s.items():
            shares = [native_s / own_s for native_s, own_s in zip(cpu_s["native"], seconds, strict=True)]
            if name != "native":
                note(of_rounds(f"web: {name}", shares, "times native"))
    for module in ("emulator", "simulator"):
        note(exact(f"web: module {module}", (BUNDLE / f"tilenca_{module}.wasm").stat().st_size, "bytes"))
    base = best["native"]["cpuS"]
    rows = [
        (
            name,
            f"{told['cpuS'] / MEASURED_S:.2f} s, {told['cpuS'] / base:.2f} times native, "
            f"{MEASURED_S / told['wallS']:.2f} times real time",
        )
        for name, told in best.items()
    ]
    rows.append(("the emulator's module, with blocks", size([BUNDLE / "tilenca_emulator.wasm"])))
    rows.append(("the simulator's module", size([BUNDLE / "tilenca_simulator.wasm"])))
    loaded = [path for path in BUNDLE.iterdir() if path.suffix == ".js" or path.name in EMULATED]
    rows.append(("what a page with emulated tiles loads: module, JavaScript, firmware", size(sorted(loaded))))
    return rows


def main() -> int:
    """Prints the table, and writes it if asked to."""
    parser = argparse.ArgumentParser(description="How fast the emulator is in a browser.")
    parser.add_argument("--write", type=Path, metavar="F", help="put the table into this document")
    parser.add_argument(
        "--rounds", type=int, default=5, help="take the best of so many (default: %(default)s)"
    )
    args = parser.parse_args()
    if not (BUNDLE / "tilenca_emulator.wasm").exists() or shutil.which("node") is None:
        print(
            "bench: nothing is built for browsers, so that is not measured; run `make web`", file=sys.stderr
        )
        return 0
    try:
        make(FIRMWARE_ELF)
        rows = measure(args.rounds)
    except (BuildError, RuntimeError) as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1
    head = ["| twenty tiles of the firmware, processor seconds per emulated second | measured |", "|---|---|"]
    table = "\n".join([*head, *(f"| {name} | {figure} |" for name, figure in rows)])
    note = f"Best of {args.rounds} rounds, in turns; other programs may have run meanwhile."
    publish(f"{table}\n\n{note}", args.write, BEGIN, END)
    return 0


if __name__ == "__main__":
    sys.exit(main())
