"""Structures for a C library's functions, right but for the fields that a test gives another value."""

from collections.abc import Mapping
from typing import Any

from tilenca.base import native_library


class Structures:
    """Makes structures and arrays, and keeps them alive as long as itself: C has only pointers to them."""

    def __init__(self, library: str) -> None:
        self.library = native_library.load(library)
        self.ffi, self.lib = self.library.ffi, self.library.lib
        self.null = self.ffi.NULL
        self._alive: list[Any] = []

    def array(self, kind: str, values: list[Any]) -> Any:
        """A C array, for example of kind `int32_t`."""
        self._alive.append(self.ffi.new(f"{kind}[]", values))
        return self._alive[-1]

    def made(self, kind: str, fields: Mapping[str, Any], other: Mapping[str, Any]) -> Any:
        """A pointer to a structure.

        Args:
            kind: its type.
            fields: their usual values.
            other: fields with another value; a list is an array of what the field points to, None is null.
        """
        types = dict(self.ffi.typeof(kind).fields)
        values = dict(fields)
        for name, value in other.items():
            is_list = isinstance(value, list)
            values[name] = self.array(types[name].type.item.cname, value) if is_list else value
        nulls = {name: self.null for name, value in values.items() if value is None}
        self._alive.append(self.ffi.new(f"{kind}*", values | nulls))
        return self._alive[-1]
