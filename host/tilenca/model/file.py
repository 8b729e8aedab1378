"""A trained model on disk, readable without torch.

A model is a directory: `model.json` (its description), `weights.npz` (float and integer weights), and beside
them `metrics.json` and `README.md` (the model card), which no program needs.
"""

import json
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.base.errors import UsageError
from tilenca.base.parsing import read_json
from tilenca.base.shipped import model_names
from tilenca.base.sides import SIDES
from tilenca.model import format_1
from tilenca.protocol.checksums import crc16
from tilenca.protocol.constants import MAX_CHANNELS  # 5 * channels fit the firmware's uint8_t
from tilenca.shapes.glyphs import GLYPHS

FORMAT = 2
FORMAT_WITH_DIRECTIONS = 3  # older readers would take such a model for one without
READABLE = (1, FORMAT, FORMAT_WITH_DIRECTIONS)
ID_VERSION = 1  # of the bytes that the model id is computed from
NEIGHBOURHOOD = 5  # von Neumann's: own state, then N, E, S, W
# For each array of weights: how many steps 1.0 has in the integer tile, and its largest value there.
SCALES = {"w1": 64, "w2": 64, "w3": 128, "b1": 4096, "b2": 4096, "b3": 8192}
LARGEST = {"w1": 127, "w2": 127, "w3": 127, "b1": 32767, "b2": 32767, "b3": 32767}
MAX_WIDTH = 127
# What the shipped digits have: channels of the state, and the width of both hidden layers.
DEFAULT_CHANNELS, DEFAULT_HIDDEN = 21, 96
CHECKPOINTS = "checkpoint-*.pt"  # the files of unfinished runs, by their seeds


def checkpoint_path(directory: Path, seed: int) -> Path:
    """The file of an unfinished training run with this seed, in a model's directory."""
    return directory / CHECKPOINTS.replace("*", str(seed))


def checkpoints(directory: Path) -> list[Path]:
    """The checkpoints of an unfinished run."""
    return sorted(directory.glob(CHECKPOINTS))


# All exceptions of numpy and zipfile on bytes that are no archive of arrays.
DAMAGED = (ValueError, EOFError, KeyError, RuntimeError, MemoryError, zipfile.BadZipFile, zlib.error)


@dataclass(frozen=True)
class Dimensions:
    """The network's widths: 5 * channels -> hidden1 -> hidden2 -> channels; by default the digits'.

    Attributes:
        channels: of the state; the last ones are the classes' scores.
        hidden1, hidden2: of the hidden layers.
        directions: 4: the channels before the classes' scores say where a tile is missing, N, E, S, W; 0: the
            model does not say it.
    """

    channels: int = DEFAULT_CHANNELS
    hidden1: int = DEFAULT_HIDDEN
    hidden2: int = DEFAULT_HIDDEN
    directions: int = 0

    def shapes(self) -> dict[str, tuple[int, ...]]:
        """The shape of every weight array, by name, in the order they are stored and hashed."""
        return {
            "w1": (self.hidden1, NEIGHBOURHOOD * self.channels),
            "b1": (self.hidden1,),
            "w2": (self.hidden2, self.hidden1),
            "b2": (self.hidden2,),
            "w3": (self.channels, self.hidden2),
            "b3": (self.channels,),
        }

    @property
    def max_classes(self) -> int:
        """Classes that fit: one channel each; channel 0 is the seed's, and directions have theirs."""
        return self.channels - 1 - self.directions

    def as_json(self) -> dict[str, int]:
        """Plain values; no directions where there are none, as in models of before."""
        return {name: width for name, width in asdict(self).items() if name != "directions" or width}


@dataclass(frozen=True)
class Model:
    """A network for one set of classes.

    Attributes:
        labels: the classes' characters; class k's score is channel `channels - len(labels) + k`.
        dimensions: the network's widths.
        integer: `w*` int8 and `b*` int16 in the units of docs/PROTOCOL.md section 4.
        floats: the float32 weights they were rounded from, same names and shapes.
        metadata: how it was made: recipe, seed, commit, shape files (free form, JSON).
    """

    labels: tuple[str, ...]
    dimensions: Dimensions
    integer: Mapping[str, NDArray[Any]]
    floats: Mapping[str, NDArray[np.float32]]
    metadata: Mapping[str, Any] = field(default_factory=dict)

    @property
    def model_id(self) -> int:
        """16-bit id of dimensions, labels and integer weights: equal networks have equal ids."""
        size = self.dimensions
        widths = bytes([ID_VERSION, size.channels, size.hidden1, size.hidden2])
        directions = bytes([size.directions]) if size.directions else b""  # no label has this character
        head = widths + directions + "".join(self.labels).encode("ascii")
        return crc16(head + b"".join(self.integer[name].tobytes() for name in size.shapes()))

    def save(self, directory: Path) -> None:
        """Writes `model.json` and `weights.npz`; the same model gives the same bytes."""
        directory.mkdir(parents=True, exist_ok=True)
        arrays = {name: self.floats[name] for name in self.dimensions.shapes()}
        arrays |= {f"int_{name}": self.integer[name] for name in self.dimensions.shapes()}
        np.savez(directory / "weights.npz", **arrays)  # type: ignore[arg-type]
        about = {
            "format": FORMAT_WITH_DIRECTIONS if self.dimensions.directions else FORMAT,
            "model_id": f"{self.model_id:04X}",
            "labels": list(self.labels),
            **self.dimensions.as_json(),
            "metadata": dict(self.metadata),
        }
        (directory / "model.json").write_text(json.dumps(about, indent=2) + "\n", encoding="utf-8")


def load_model(directory: Path) -> Model:
    """Reads a model directory.

    Raises:
        UsageError: no model, of another format, or damaged; the message names file and remedy.
    """
    about_path, weights_path = directory / "model.json", directory / "weights.npz"
    try:
        about = read_json(about_path.read_text(encoding="utf-8"))
    except OSError as error:
        if checkpoints(directory):
            raise UsageError(
                f"{directory}: holds an unfinished training run; finish it with `tilenca train ... --resume`"
            ) from error
        raise UsageError(
            f"{about_path}: {error.strerror}; give what `tilenca train` wrote, "
            f"or one of: {' '.join(model_names())}"
        ) from error
    except ValueError as error:
        raise UsageError(f"{about_path}: not a model description ({error}); train again") from error
    found = about.get("format") if isinstance(about, dict) else None
    if found not in READABLE:
        raise UsageError(
            f"{about_path}: model format {found!r}, this tilenca reads {READABLE[-1]}; train again"
        )
    dimensions, labels = _description(about_path, about)
    model = Model(labels, dimensions, *_weights(weights_path, dimensions), _metadata(about_path, about))
    if about.get("model_id") != f"{model.model_id:04X}":
        raise UsageError(
            f"{weights_path}: the weights have id {model.model_id:04X}, {about_path.name} says "
            f"{about.get('model_id')!r}; the two files do not belong together, train or get it again"
        )
    return model


def _description(path: Path, about: dict[str, Any]) -> tuple[Dimensions, tuple[str, ...]]:
    widths: list[Any] = [about.get(key) for key in ("channels", "hidden1", "hidden2")]
    if (
        not all(type(width) is int and 1 <= width <= MAX_WIDTH for width in widths)
        or widths[0] > MAX_CHANNELS
    ):
        raise UsageError(
            f"{path}: channels, hidden1, hidden2 are {widths}; "
            f"the most are {MAX_CHANNELS}, {MAX_WIDTH} and {MAX_WIDTH}"
        )
    directions = about.get("directions", 0)
    if type(directions) is not int or directions not in (0, len(SIDES)) or widths[0] <= directions:
        raise UsageError(f"{path}: directions are {directions!r}, they must be {len(SIDES)} or none")
    dimensions = replace(Dimensions(*widths), directions=directions)
    labels = about.get("labels")
    if not (isinstance(labels, list) and labels and all(isinstance(x, str) and x in GLYPHS for x in labels)):
        raise UsageError(f"{path}: labels must be a list of characters that a 7-segment digit can show")
    if len(labels) > dimensions.max_classes or len(set(labels)) != len(labels):
        raise UsageError(
            f"{path}: {len(labels)} labels; they must differ and be at most {dimensions.max_classes}"
        )
    return dimensions, tuple(labels)


def _metadata(path: Path, about: dict[str, Any]) -> dict[str, Any]:
    """How the model was made: free form, but for the recipe, whose settings decide how it is simulated."""
    metadata = format_1.metadata_of(about) if about["format"] == 1 else about.get("metadata", {})
    if not isinstance(metadata, dict) or not isinstance(metadata.get("recipe", {}), dict):
        raise UsageError(f"{path}: metadata, and metadata.recipe, must be objects; train or get it again")
    return metadata


def _weights(
    path: Path, dimensions: Dimensions
) -> tuple[dict[str, NDArray[Any]], dict[str, NDArray[np.float32]]]:
    try:
        archive = np.load(path, allow_pickle=False)
        if not isinstance(archive, np.lib.npyio.NpzFile):
            raise ValueError("not an .npz archive")
        with archive:
            arrays = {name: archive[name] for name in archive.files}
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror or error}; train or get it again") from error
    except DAMAGED as error:
        raise UsageError(f"{path}: damaged ({error}); train or get it again") from error
    integer: dict[str, NDArray[Any]] = {}
    floats: dict[str, NDArray[np.float32]] = {}
    for name, shape in dimensions.shapes().items():
        wanted = np.dtype(np.int8 if name.startswith("w") else "<i2")
        integer[name] = _array(path, arrays, f"int_{name}", shape, wanted)
        floats[name] = _array(path, arrays, name, shape, np.dtype("<f4"))
    return integer, floats


def _array(
    path: Path, arrays: dict[str, Any], name: str, shape: tuple[int, ...], dtype: np.dtype[Any]
) -> NDArray[Any]:
    array = arrays.get(name)
    if not isinstance(array, np.ndarray) or array.shape != shape or array.dtype != dtype:
        raise UsageError(f"{path}: array '{name}' is missing or not {shape} of {dtype}; train again")
    return array
