"""Lays out the page that needs no server of its own: python -m release.page_bundle WEB OUT [MODEL...].

WEB is what `make web` has built. OUT gets the page, the emulator's WebAssembly, each program of JavaScript
as one file, the firmware, and what there is to see of it: labels, looks, drawings. Each MODEL, a name of
those that ship, or "all", is one more to choose from: its firmware, built if need be, is fetched by whoever
chooses it.
"""

import gzip
import json
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
from tilenca.page.joined import joined
from tilenca.page.offer import Offer, load_offer
from tilenca.page.server import ENTRIES

# Where page/stream/emulator.js looks for it.
EMULATOR = "emulator"
WORKER = "stream/worker.js"
FILES = ("tilenca_emulator.wasm", "firmware.elf")
# Where web/src/stream/worker.js looks for the others.
MODELS = "models"
ALL = "all"
MOST_GZIPPED = 1_000_000  # bytes of all files
OFFER_GZIPPED = 4_000  # room for what there is to see of a model


class BundleError(Exception):
    """Something that the bundle needs is missing."""


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
    if missing := [name for name in (*FILES, WORKER) if not (web / name).is_file()]:
        raise BundleError(f"{web / missing[0]}: not there; run: make web")
    added = chosen(names)
    shutil.rmtree(out, ignore_errors=True)
    _lay_out_page(web, out)
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
        _copy(image, out / EMULATOR / MODELS / f"{model.name}.elf")
        models.append(model)
    for model in models:
        offer = EMULATOR + ("/offer" if model is first else f"/{MODELS}/{model.name}")
        image = out / EMULATOR / "firmware.elf" if model is first else out / f"{offer}.elf"
        told = offer_of(image, model.offer, model.name, models if len(models) > 1 else ())
        (out / f"{offer}.json").write_text(told + "\n", encoding="utf-8")


def _lay_out_page(web: Path, out: Path) -> None:
    """Writes the page, and the emulator with the firmware that it was built for."""
    for path in paths.PAGE.rglob("*"):
        if path.is_file() and path.suffix != ".js":
            _copy(path, out / path.relative_to(paths.PAGE))
    document = out / "index.html"
    text = document.read_text(encoding="utf-8")
    if text.count(BEHIND.format("server")) != 1:
        raise BundleError(f"{document}: it does not say once what stands behind the page")
    document.write_text(text.replace(BEHIND.format("server"), BEHIND.format("emulator")), encoding="utf-8")
    programs = {name: joined(paths.PAGE, name) for name in ENTRIES}
    programs[f"{EMULATOR}/{WORKER}"] = joined(web, WORKER)
    for name, text in programs.items():
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).write_text(text, encoding="utf-8")
    for name in FILES:
        _copy(web / name, out / EMULATOR / name)
    (out / "alone.html").write_text(page_alone(paths.PAGE), encoding="utf-8")


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


def _copy(path: Path, to: Path) -> None:
    to.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(path, to)


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
