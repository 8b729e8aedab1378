"""Lays out the page that needs no server of its own: python -m release.page_bundle WEB OUT.

WEB is what `make web` has built. OUT gets the page, the emulator's WebAssembly with the JavaScript that it
needs, the firmware, and what there is to see of it: labels, looks, drawings.
"""

import json
import re
import shutil
import sys
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import TilencaError
from tilenca.emulator.greeting import firmware_settings
from tilenca.page.alone import BEHIND, page_alone
from tilenca.page.emulated import EmulatedSource
from tilenca.page.offer import load_offer

# Where page/stream/emulator.js looks for it.
EMULATOR = "emulator"
WORKER = Path("stream/worker.js")
FILES = ("tilenca_emulator.wasm", "firmware.elf")
_IMPORT = re.compile(r"""^(?:import|export)\b[^"';]*?from\s*"(\.[^"]+)";""", re.MULTILINE)


class BundleError(Exception):
    """Something that the bundle needs is missing."""


def modules_of(web: Path, entry: Path) -> set[Path]:
    """The modules that one needs, itself included, as paths within `web`.

    Raises:
        BundleError: one of them is not there.
    """
    found: set[Path] = set()
    waiting = [web / entry]
    while waiting:
        module = waiting.pop().resolve()
        if module.relative_to(web.resolve()) in found:
            continue
        if not module.is_file():
            raise BundleError(f"{module}: not there; run: make web")
        found.add(module.relative_to(web.resolve()))
        waiting += [module.parent / name for name in _IMPORT.findall(module.read_text(encoding="utf-8"))]
    return found


def offer_of(image: Path) -> str:
    """The first event of the page's stream, and what tiles get as their settings, as JSON."""
    defaults = firmware_settings(image)
    offer = load_offer()
    source = EmulatedSource(image, defaults, offer.labels, offer.drawings)
    return json.dumps(
        {
            "stream": source.begin()[0],
            "period_ms": defaults and defaults.period_ms,
            "updates": defaults.updates if defaults else 0,
        },
        separators=(",", ":"),
    )


def lay_out(web: Path, out: Path) -> None:
    """Writes the bundle; what was in `out` before is gone.

    Raises:
        BundleError: `make web` has not been there.
        TilencaError: the firmware or a shape file cannot be used.
    """
    needed = [*map(Path, FILES), *sorted(modules_of(web, WORKER))]
    if missing := [name for name in needed if not (web / name).is_file()]:
        raise BundleError(f"{web / missing[0]}: not there; run: make web")
    shutil.rmtree(out, ignore_errors=True)
    shutil.copytree(paths.PAGE, out)
    document = out / "index.html"
    text = document.read_text(encoding="utf-8")
    if text.count(BEHIND.format("server")) != 1:
        raise BundleError(f"{document}: it does not say once what stands behind the page")
    document.write_text(text.replace(BEHIND.format("server"), BEHIND.format("emulator")), encoding="utf-8")
    for name in needed:
        (out / EMULATOR / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(web / name, out / EMULATOR / name)
    (out / "alone.html").write_text(page_alone(paths.PAGE), encoding="utf-8")
    (out / EMULATOR / "offer.json").write_text(offer_of(web / "firmware.elf") + "\n", encoding="utf-8")


def main(arguments: list[str]) -> int:
    """Lays it out; returns the exit status."""
    if len(arguments) != 2:
        print("usage: python -m release.page_bundle WEB OUT", file=sys.stderr)
        return 2
    web, out = map(Path, arguments)
    try:
        lay_out(web, out)
    except (BundleError, TilencaError) as error:
        print(f"page_bundle: {error}", file=sys.stderr)
        return 4
    print(out / "index.html")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
