"""Renders a model into the firmware's C++ files.

Each file's first line names the model and holds a checksum of all following lines, so that `export` notices a
change made by hand before it overwrites it.
"""

import hashlib
import os
import re
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from numpy.typing import NDArray

from tilenca.base.errors import BuildError
from tilenca.model import cost, packing
from tilenca.model.file import Model
from tilenca.shapes.glyphs import looks_of

# Template and, below the firmware's folder, the file it renders.
TEMPLATES = {"model.h.j2": Path("include/model/model.h"), "model.cpp.j2": Path("src/model/model.cpp")}
# The widest accumulator of the tile's kernel: 24 bits, signed.
ACCUMULATOR_MAX = 2**23 - 1
ROW_LINES = 4  # rows of weights per line of C++
HEADER = re.compile(
    r"// Rendered by `tilenca export` from model ([0-9A-F]{4}); do not edit. Body ([0-9a-f]{16})\n"
)


def check_fits(model: Model) -> None:
    """Refuses a model that the firmware cannot run.

    Raises:
        BuildError: too wide, too large, a weight of -128, or an accumulator that could wrap.
    """
    cost.check(model.dimensions, len(model.labels))
    for layer in (1, 2, 3):
        if model.integer[f"w{layer}"].min() < -packing.ACTIVATION_MAX:
            raise BuildError(
                f"model {model.model_id:04X}: w{layer} has a weight of -128; quantise to -127..127"
            )
        bound = max(max(-one.least, one.most) for one in packing.blocks(model, layer))
        if bound > ACCUMULATOR_MAX:
            raise BuildError(
                f"model {model.model_id:04X}: layer {layer} could add up to {bound}, beyond the 24-bit "
                f"{ACCUMULATOR_MAX}; train with more weight decay or fewer inputs"
            )


def _lines(layer: list[packing.Block]) -> Iterator[str]:
    """A layer's stream as lines of C++: for each block a comment, its biases, then its rows."""
    for one in layer:
        bits = 16 if one.is_16_bit else 24
        first, last = one.outputs.start, one.outputs.stop - 1
        yield f"// outputs {first}..{last}, sums {one.least}..{one.most}: {bits} bits"
        width = packing.BLOCK_OUTPUTS
        head, rows = np.split(one.stream, [packing.HEAD_BYTES])
        yield _line(head)
        for start in range(0, len(rows), ROW_LINES * width):
            yield _line(rows[start : start + ROW_LINES * width])


def _line(values: NDArray[np.uint8]) -> str:
    return " ".join(f"{value}," for value in values)


def render(model: Model) -> dict[Path, str]:
    """The model's C++ files: path below the firmware's folder -> whole text; equal models give equal text."""
    environment = Environment(
        loader=PackageLoader("tilenca.model"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # C++, not HTML
    )
    widths = (("kNeighbourhood * kChannels", "kHidden1"), ("kHidden1", "kHidden2"), ("kHidden2", "kChannels"))
    layers = []
    for number, (inputs, outputs) in enumerate(widths, 1):
        layer = packing.blocks(model, number)
        layers.append(
            {
                "name": f"kLayer{number}",
                "inputs": inputs,
                "outputs": outputs,
                "lines": list(_lines(layer)),
                "only_16_bit": str(all(one.is_16_bit for one in layer)).lower(),
                "rounding": "kHiddenRounding" if number < len(widths) else "0",
            }
        )
    context = {"model_id": model.model_id, "size": model.dimensions, "layers": layers}
    files = {}
    for template, path in TEMPLATES.items():
        body = environment.get_template(template).render(context, looks=looks_of(model.labels))
        files[path] = _header(model.model_id, body) + body
    return files


def _header(model_id: int, body: str) -> str:
    digest = hashlib.sha256(body.encode()).hexdigest()[:16]
    return f"// Rendered by `tilenca export` from model {model_id:04X}; do not edit. Body {digest}\n"


def _refuse_foreign(path: Path) -> None:
    """Raises BuildError if `path` holds anything that `export` did not write."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        return
    except (OSError, UnicodeDecodeError) as error:
        raise BuildError(f"{path}: cannot be read ({error}); move it away or pass --force") from error
    header = HEADER.match(text)
    if header is None:
        raise BuildError(f"{path}: was not rendered by tilenca export; move it away or pass --force")
    if _header(int(header[1], 16), text[header.end() :]) != header[0]:
        raise BuildError(f"{path}: was edited by hand; move it away or pass --force")


def write_files(out: Path, files: dict[Path, str], force: bool = False) -> None:
    """Writes rendered files below `out`: all of them or, if anything is in the way, none; never half a file.

    A file that is already as it should be is left alone, so that nothing is compiled anew for it.

    Raises:
        BuildError: no such folder, not writable, or a file with other content is in the way.
    """
    if not out.is_dir():
        raise BuildError(f"{out}: no such folder; give the firmware's folder to --out")
    stale = {out / path: text for path, text in files.items() if not is_current(out / path, text)}
    if not force:
        for path in stale:
            _refuse_foreign(path)
    try:
        with ExitStack() as leftovers:
            ready = []
            for path, text in stale.items():
                path.parent.mkdir(parents=True, exist_ok=True)
                temporary = path.with_name(f".{path.name}.{os.getpid()}")
                leftovers.callback(temporary.unlink, missing_ok=True)
                temporary.write_text(text, encoding="utf-8")
                ready.append((temporary, path))
            for temporary, path in ready:
                temporary.replace(path)
    except OSError as error:
        where = error.filename or out
        raise BuildError(f"{where}: {error.strerror}; make {out} writable or give another --out") from error


def is_current(path: Path, text: str) -> bool:
    """Whether the file is there and holds exactly `text`."""
    try:
        return path.read_text(encoding="utf-8") == text
    except (OSError, UnicodeDecodeError):
        return False
