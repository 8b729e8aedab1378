"""`tilenca export`: renders a model into the firmware's C++ files, or says what one would cost."""

import argparse
import json
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import TilencaError, UsageError
from tilenca.base.project import project
from tilenca.base.stdio import warn
from tilenca.commands import export_plan
from tilenca.commands.arguments import add_model_argument
from tilenca.commands.own_firmware import build_beside
from tilenca.model import cost, packing
from tilenca.model.file import Model, load_model
from tilenca.model.render import check_fits, is_current, render, write_files


def _sums(model: Model) -> str:
    """Which sums are proven to need 16 bits only; one line."""
    in_16_bits = [
        f"layer {layer} {one.outputs.start}..{one.outputs.stop - 1}"
        for layer in (1, 2, 3)
        for one in packing.blocks(model, layer)
        if one.is_16_bit
    ]
    return f"sums of 16 bits: {', '.join(in_16_bits) or 'none'}; of 24 bits: all others"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments of `tilenca export`."""
    add_model_argument(parser)
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="the firmware's folder to render into (the project's firmware/)",
    )
    parser.add_argument(
        "--build",
        action="store_true",
        help="render and build beside the model instead; the project's own firmware stays as it is",
    )
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 if a file is not current")
    parser.add_argument("--force", action="store_true", help="overwrite files that were edited by hand")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    export_plan.add_arguments(parser)


def run(args: argparse.Namespace) -> int:
    """Renders, or checks, the files, or estimates what a network to be would cost; prints what was done."""
    if export_plan.asked(args):
        return export_plan.run(args)
    if args.build and (args.check or args.out):
        raise UsageError("--build has a folder of its own beside the model; leave out --out and --check")
    model = load_model(args.model)
    check_fits(model)
    out: Path = args.out or (paths.model_firmware(args.model) if args.build else project() / "firmware")
    fit = cost.check(model.dimensions, len(model.labels))
    if not fit.fits_period:
        warn(
            f"note: this model needs a period of {fit.shortest_period_ms} ms, and the firmware's is "
            f"{fit.period_ms} ms: {export_plan.longer_period(fit)}"
        )
    files = render(model)
    differing = [str(out / path) for path, text in files.items() if not is_current(out / path, text)]
    if args.build:
        build_beside(model, args.model, args.force)
    elif not args.check:
        write_files(out, files, args.force)
    report = {
        "files": [str(out / path) for path in files],
        "flash_bytes": cost.flash_bytes(model.dimensions, len(model.labels)),
        "model_id": f"{model.model_id:04X}",
        "outputs_in_16_bits": [
            packing.outputs_in_16_bits(packing.blocks(model, layer)) for layer in (1, 2, 3)
        ],
        "differing" if args.check else "written": differing,
        **({"image": str(paths.model_elf(args.model))} if args.build else {}),
    }
    if args.json:
        print(json.dumps(report))
    if args.check and differing:
        names = ", ".join(differing)
        raise TilencaError(
            f"{names}: not what {args.model} renders to; run: tilenca export --model {args.model}"
        )
    if not args.json:
        state = "current" if args.check or not differing else "written"
        for path in files:
            print(f"{out / path}: {state}")
        print(f"model {report['model_id']}, {report['flash_bytes']} bytes of flash")
        print(_sums(model))
        if args.build:
            print(f"firmware in {paths.model_elf(args.model)}")
            warn(f"next: tilenca emulate --model {args.model}")
        elif not args.check:
            warn("next: pio run")
    return 0
