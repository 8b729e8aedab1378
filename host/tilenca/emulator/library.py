"""The compiled emulator: tools/emulator/include/tilenca/emulator.h in Python."""

from functools import cache
from typing import Any

from tilenca.base import native_library
from tilenca.base.native_library import Library

LIBRARY = native_library.find("emulator").library


@cache
def library() -> Library:
    """The compiled emulator.

    Raises:
        BuildError: it has not been built, or cannot be used; the message says what to run.
    """
    return native_library.load("emulator")


def call(function: str, *arguments: Any) -> Any:
    """What `tilenca_FUNCTION` returns.

    Raises:
        UsageError: it failed; with the library's own words.
    """
    return library().call(function, *arguments)


def new(kind: str, *initial: Any) -> Any:
    """Memory for C values, such as `new("uint8_t[]", 10)`: zeros, or what is given."""
    return library().ffi.new(kind, *initial)


def text(pointer: Any) -> str:
    """The text that a C string holds."""
    return str(library().ffi.string(pointer).decode(errors="replace"))


def numbers(array: Any, count: int) -> list[Any]:
    """The first elements of a C array."""
    found: list[Any] = library().ffi.unpack(array, count) if count else []
    return found
