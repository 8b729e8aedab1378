"""How what is damaged is refused: in lines that say where."""

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import pytest

from tilenca.base.errors import UsageError
from tilenca.model.file import load_model

T = TypeVar("T")


def refusal(model: Path) -> str:
    with pytest.raises(UsageError) as caught:
        load_model(model)
    message = str(caught.value)
    assert "\n" not in message
    return message


def read_or_refused(
    path: Path, content: bytes, read: Callable[[Path], T], within: Path | None = None
) -> T | None:
    """What a reader makes of a file of any bytes; None: it refused them. The file stays as it is.

    Args:
        path: the file, which is written here.
        content: its bytes.
        read: may raise a `UsageError` of lines that each begin with the file, and nothing else.
        within: the folder that a message may begin with instead.
    """
    path.write_bytes(content)
    found = None
    try:
        found = read(path)
    except UsageError as error:
        lines = str(error).split("\n")
        assert all(line.startswith(str(within or path)) for line in lines)
    assert path.read_bytes() == content
    return found
