"""A model knows what it was made of: its shape files, and which model a firmware carries."""

import hashlib
import shlex
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.base.parsing import read_json
from tilenca.base.stdio import warn
from tilenca.model.file import Model, load_model
from tilenca.shapes.file import UNKNOWN, Task, load_task
from tilenca.shapes.sizes import Size, size_name
from tilenca.shapes.trainable import extent

MOST_NAME = 255  # bytes; systems refuse longer ones
NEAR = 3  # folders above a model in which its shape files are looked for
FULL = "--recipe full (ten drawings: 12 minutes on two free cores)"


def shapes_or_own(given: list[Path] | None, model: Model, folder: Path) -> list[Path]:
    """The files that were given, else those that the model was trained on."""
    return given or own_shapes(model, folder)


def own_shapes(model: Model, folder: Path) -> list[Path]:
    """The shape files that a model was trained on; the digits where its metadata name none.

    Args:
        model: with metadata.
        folder: that it was read from; the files are looked for there too.

    Raises:
        UsageError: a file is not there any more; the message says what to give.
    """
    hashes = _hashes(model)
    named = model.metadata.get("shapes") or list(hashes)[:1]
    if not (isinstance(named, list) and all(map(_is_name, named)) and named):
        return [paths.DEFAULT_SHAPES]
    return [_find(name, hashes.get(Path(name).name), folder) for name in named]


def _hashes(model: Model) -> dict[str, str]:
    """The SHA-256 of each file that the metadata name, by its name."""
    sources: list[tuple[str, str]] = []
    with suppress(TypeError, KeyError):
        sources = [(str(one["file"]), str(one["sha256"])) for one in model.metadata.get("sources", [])]
    return {name: sha256 for name, sha256 in sources if _is_name(name)}


def _is_name(name: object) -> bool:
    """Whether it may be the name of a file, and goes into a line."""
    return isinstance(name, str) and name.isprintable() and len(name.encode()) <= MOST_NAME


def _find(name: str, sha256: str | None, folder: Path) -> Path:
    """The file of that name, best with the content that the model was trained on."""
    found = _places(name, folder)
    for path in found:
        if sha256 is None or hashlib.sha256(path.read_bytes()).hexdigest() == sha256:
            return path
    if not found:
        raise UsageError(f"{folder}: was trained on {name}, which is not there; give the file with --shapes")
    if (
        not found[0].resolve().is_relative_to(paths.SHAPES.resolve())
    ):  # what ships together is tested together
        warn(f"note: {found[0]} has changed since {folder} was trained on it")
    return found[0]


def _places(name: str, folder: Path) -> list[Path]:
    """The files of that name: here, in the project, near the model, and among those that ship."""
    roots = [Path(), *([paths.PROJECT] if paths.PROJECT else []), paths.ROOT]
    roots += [folder, *folder.resolve().parents[:NEAR]]
    found = [path for root in roots if (path := root / name).is_file()]
    return found + [path for path in [paths.SHAPES / Path(name).name] if path.is_file() and path not in found]


def model_with_id(model_id: int, first: Path | None = None) -> tuple[Model, Path] | None:
    """The model of that id and its folder: among those of the project, and those that come with tilenca.

    Args:
        model_id: of its weights.
        first: a folder to look in before.
    """
    for about in [*([first / "model.json"] if first else []), *_descriptions()]:
        with suppress(OSError, ValueError, AttributeError):
            if read_json(about.read_text(encoding="utf-8")).get("model_id") != f"{model_id:04X}":
                continue
            with suppress(UsageError):
                return load_model(about.parent), about.parent
    return None


def _descriptions() -> Iterator[Path]:
    roots = [paths.MODELS]
    if paths.PROJECT is not None:
        roots += [paths.PROJECT / "models", paths.PROJECT / "build" / "models"]
    for root in dict.fromkeys(roots):
        yield from sorted(root.glob("*/model.json"))


def own_drawings(model: Model, folder: Path, task: Task) -> set[str]:
    """The names of the drawings of a file that the model was made of, as drawn: all, if the file is its own.

    Args:
        model: with metadata.
        folder: that it was read from; its shape files are looked for there too.
        task: the file's.
    """
    if _is_of(model, task):
        return {shape.name for shape in task.shapes}
    own: set[tuple[str, tuple[str, ...]]] = set()
    for name, sha256 in _hashes(model).items():
        for path in _places(name, folder):
            if hashlib.sha256(path.read_bytes()).hexdigest() == sha256:
                own |= {(shape.label, shape.rows) for shape in load_task(path).shapes}
                break
    return {shape.name for shape in task.shapes if (shape.label, shape.rows) in own}


def _is_of(model: Model, task: Task) -> bool:
    """Whether the model was made of this file; what ships together is."""
    named = _hashes(model)
    ships_with_it = task.path.name in named and task.path.resolve().is_relative_to(paths.SHAPES.resolve())
    return ships_with_it or hashlib.sha256(task.path.read_bytes()).hexdigest() in named.values()


def folder_of(task: Task) -> Path | None:
    """The folder of a model that was made of this file, here or in the project; None: there is none."""
    sha256 = hashlib.sha256(task.path.read_bytes()).hexdigest()
    for about in [*sorted(Path("models").glob("*/model.json")), *_descriptions()]:
        with suppress(OSError, UnicodeDecodeError, UsageError):
            if sha256 in about.read_text(encoding="utf-8") and _is_of(load_model(about.parent), task):
                return about.parent
    return None


def _was_trained_at(model: Model, task: Task, size: Size) -> bool:
    """Whether the drawings of the model's own file were stretched to a size in its training."""
    stretch = 1.0
    with suppress(TypeError, KeyError, ValueError):
        stretch = float(model.metadata["recipe"]["stretch"])
    sizes = task.sizes.within(extent(task), stretch)
    return size in (extent(task), *sizes.trained, *sizes.more)


def why_wrong(model: Model, task: Task, size: Size | None = None) -> str:
    """What to look at where tiles run the right model and show another label than the file says.

    Args:
        model: that they run.
        task: the file's.
        size: that its drawings were stretched to; None: they are as drawn.
    """
    id_text = f"{model.model_id:04X}"
    if size is not None and _is_of(model, task) and not _was_trained_at(model, task, size):
        made = (
            f"model {id_text} was made of this file, and never trained at {size_name(size)}; give the file "
            f"[sizes] that go there, and run tilenca make {shlex.quote(str(task.path))} --recipe full --force"
        )
    elif _is_of(model, task):
        made = f"model {id_text} was made of this file, and does not hold it; a better one: {FULL}"
    else:
        named = [*_hashes(model)]
        files = " ".join(named) or "other drawings"
        into, make = "one shape file with those", "tilenca make on it"
        if named and (paths.SHAPES / named[0]).is_file():
            into = f"a copy of shapes/{named[0]}"
        elif named:
            into = named[0]
            make = f"tilenca make {into} --force"
        made = (
            f"model {id_text} was made of {files}, and takes these for something else; put these drawings, "
            f"with their labels, into {into} and run {make}; or train with the recipe that knows damage, "
            f"{FULL}"
        )
    return f"{made}; more reasons: docs/how-to/debug.md"


def knows_no_damage(model: Model) -> str | None:
    """What to say where a tile is off and the others are wrong; None where training knew missing tiles."""
    damaged: object = None
    with suppress(TypeError, KeyError):
        damaged = model.metadata["recipe"]["damaged"]
    if damaged != 0:
        return None
    return (
        f"model {model.model_id:04X} never met a drawing with a tile missing, and may take what is left for "
        f"another one; a recipe that knows damage: {FULL}"
    )


def without_a_dash(model: Model) -> str | None:
    """A warning about a model that knows no drawings but its own; None where it shows a dash on others."""
    if UNKNOWN in model.labels:
        return None
    return (
        f"note: model {model.model_id:04X} has no class for other drawings, and shows one of its own labels "
        f"({' '.join(model.labels)}) on any; --recipe full trains a dash for them"
    )
