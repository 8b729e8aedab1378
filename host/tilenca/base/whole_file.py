"""Files that are written whole or not at all."""

from contextlib import suppress
from pathlib import Path

from tilenca.base.errors import TilencaError


def write_whole(
    path: Path, data: bytes | memoryview, remedy: str, error_type: type[TilencaError] = TilencaError
) -> None:
    """Writes a file; an interrupted write leaves the one before, and no half one.

    Args:
        path: the file; its folder is there.
        data: its content.
        remedy: what to do where it cannot be written.
        error_type: of the error then.

    Raises:
        TilencaError: the disk is full or not writable; of the type that was given.
    """
    partial = path.with_name(f"{path.name}.part")
    try:
        partial.write_bytes(data)
        partial.replace(path)
    except OSError as error:
        raise error_type(f"{path}: {error.strerror}; {remedy}") from error
    finally:
        with suppress(OSError):  # a folder that is none, or not ours: the error above says it
            partial.unlink()
