"""Lays out the page that needs no server of its own: python -m release.page_bundle WEB OUT [MODEL...].

WEB is what `make web` has built. OUT gets the page, the emulator's WebAssembly with the JavaScript that it
needs, the firmware, and what there is to see of it: labels, looks, drawings. Each MODEL, a name of those that
ship, or "all", is one more to choose from: its firmware, built if need be, is fetched by whoever chooses it.
"""

import gzip
import json
import re
import shutil
import sys
import threading
from collections.abc import Sequence
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import TilencaError
from tilenca.base.stdio import warn
from tilenca.commands.page_models import page_models
from tilenca.emulator.greeting import firmware_settings
from tilenca.page.alone import BEHIND, page_alone
from tilenca.page.chosen import ModelOffer
from tilenca.page.emulated import EmulatedSource
from tilenca.page.offer import Offer, load_offer

# Where page/stream/emulator.js looks for it.
EMULATOR = "emulator"
WORKER = Path("stream/worker.js")
FILES = ("tilenca_emulator.wasm", "firmware.elf")
# Where web/src/stream/worker.js looks for the others.
MODELS = "models"
ALL = "all"
MOST_GZIPPED = 1_000_000  # bytes of all files
OFFER_GZIPPED = 4_000  # room for what there is to see of a model
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


def offer_of(
    image: Path, offer: Offer | None = None, model: str = "", models: Sequence[ModelOffer] = ()
) -> str:
    """The first event of the page's stream, and what tiles get as their settings, as JSON.

    Args:
        image: the firmware.
        offer: what there is to see of it; None: the digits.
        model: its name, of those to choose from.
        models: those to choose from, if there are several.
    """
    defaults = firmware_settings(image)
    offer = offer or load_offer()
    source = EmulatedSource(image, defaults, offer.labels, offer.drawings)
    choice = [{"name": one.name, "id": one.id_text, "labels": list(one.offer.labels)} for one in models]
    return json.dumps(
        {
            "stream": {**source.begin()[0], **({"models": choice, "model": model} if choice else {})},
            "period_ms": defaults and defaults.period_ms,
            "updates": defaults.updates if defaults else 0,
        },
        separators=(",", ":"),
    )


def lay_out(web: Path, out: Path, names: Sequence[str] = ()) -> None:
    """Writes the bundle; what was in `out` before is gone.

    Args:
        web: what `make web` has built.
        out: the folder.
        names: of the models to choose from, beside that of the firmware. Those for which there is no room are
            left out, with a warning.

    Raises:
        BundleError: `make web` has not been there.
        TilencaError: the firmware or a shape file cannot be used.
    """
    needed = [*map(Path, FILES), *sorted(modules_of(web, WORKER))]
    if missing := [name for name in needed if not (web / name).is_file()]:
        raise BundleError(f"{web / missing[0]}: not there; run: make web")
    added = chosen(names)
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
    [first] = page_models(web / "firmware.elf", None, ())
    room = MOST_GZIPPED - sum(map(_gzipped, out.rglob("*")))
    models = [first]
    for model in added:
        image = model.image(threading.Event())
        needed_bytes = _gzipped(image) + OFFER_GZIPPED
        if needed_bytes > room:
            warn(
                f"{model.name}: left out, since the bundle would have more than {MOST_GZIPPED} bytes gzipped"
            )
            continue
        room -= needed_bytes
        (out / EMULATOR / MODELS).mkdir(exist_ok=True)
        shutil.copyfile(image, out / EMULATOR / MODELS / f"{model.name}.elf")
        models.append(model)
    for model in models:
        offer = EMULATOR + ("/offer" if model is first else f"/{MODELS}/{model.name}")
        image = out / EMULATOR / "firmware.elf" if model is first else out / f"{offer}.elf"
        told = offer_of(image, model.offer, model.name, models if len(models) > 1 else ())
        (out / f"{offer}.json").write_text(told + "\n", encoding="utf-8")


def chosen(names: Sequence[str]) -> list[ModelOffer]:
    """The models with these names, or ALL that the page can show.

    Raises:
        BundleError: one of them does not ship, or is that of the firmware.
    """
    if not names:
        return []
    found = {model.name: model for model in page_models(None, None, ())[1:]}
    if list(names) == [ALL]:
        return list(found.values())
    if unknown := [name for name in names if name not in found]:
        raise BundleError(f"{unknown[0]}: no model to add; there are {', '.join(sorted(found))}")
    return [found[name] for name in names]


def _gzipped(path: Path) -> int:
    return len(gzip.compress(path.read_bytes())) if path.is_file() else 0


def main(arguments: list[str]) -> int:
    """Lays it out; returns the exit status."""
    if len(arguments) < 2:
        print("usage: python -m release.page_bundle WEB OUT [MODEL...]", file=sys.stderr)
        return 2
    web, out = map(Path, arguments[:2])
    try:
        lay_out(web, out, arguments[2:])
    except (BundleError, TilencaError) as error:
        print(f"page_bundle: {error}", file=sys.stderr)
        return 4
    print(out / "index.html")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
