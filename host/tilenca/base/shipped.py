"""Short names of the shapes and models that ship with tilenca: `hex` is `shapes/hex.toml` or `models/hex`."""

from pathlib import Path

from tilenca.base import paths

SHAPES_SUFFIX = ".toml"


def shapes_names() -> list[str]:
    """The short names of the shape files, sorted."""
    return sorted(path.stem for path in paths.SHAPES.glob(f"*{SHAPES_SUFFIX}"))


def model_names() -> list[str]:
    """The short names of the models, sorted."""
    return sorted(path.parent.name for path in paths.MODELS.glob("*/model.json"))


def shapes_file(text: str) -> Path:
    """The shape file that a user means: one of that path, else one that comes with tilenca.

    Args:
        text: a path, a short name such as `hex`, or a path in the tree such as `shapes/hex.toml`.

    Returns:
        The file; where nothing fits, the path as it was given, which may not exist.
    """
    given = Path(text)
    if not given.is_file() and _inner_name(given, paths.SHAPES.name, SHAPES_SUFFIX) in shapes_names():
        return paths.SHAPES / f"{given.stem}{SHAPES_SUFFIX}"
    return given


def model_folder(text: str) -> Path:
    """The model's directory that a user means; as `shapes_file`, with `models/hex` for a path in the tree.

    A model in the folder `models`, in the project or here, has a short name, too.
    """
    given = Path(text)
    if len(given.parts) == 1 and not given.exists():
        for folder in (*([paths.PROJECT] if paths.PROJECT else []), Path()):
            own = folder / "models" / given.name
            if (own / "model.json").exists():
                return own
    if not given.exists() and _inner_name(given, paths.MODELS.name, "") in model_names():
        return paths.MODELS / given.name
    return given


def _inner_name(given: Path, folder: str, suffix: str) -> str | None:
    """The name in `NAME` or `folder/NAME.suffix`; None: the path is of neither form."""
    if len(given.parts) == 1:
        return given.name
    is_inside = given.parts[:-1] == (folder,) and given.suffix == suffix
    return given.stem if is_inside else None
