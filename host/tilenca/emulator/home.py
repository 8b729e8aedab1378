"""The array that a tile is in, as the tile sees it."""

from typing import Any, Protocol

from tilenca.base.errors import UsageError


class Home(Protocol):
    """What a tile needs of the array it is in."""

    @property
    def handle(self) -> Any:
        """The array as the C library knows it."""

    def symbol(self, name: str) -> tuple[int, int]:
        """Address and size of a symbol."""

    def code_address(self, place: str | int) -> int:
        """Byte address of a function, or the number given."""

    def function_at(self, address: int) -> str:
        """The function that contains a byte of flash."""


class Nowhere:
    """Where a tile is that an array no longer has."""

    @property
    def handle(self) -> Any:
        """Refused."""
        raise UsageError("this tile came after the moment that was restored; it is no more")

    def symbol(self, name: str) -> tuple[int, int]:
        """Refused."""
        raise UsageError(f"'{name}' of a tile that is no more")

    def code_address(self, place: str | int) -> int:
        """Refused."""
        raise UsageError(f"'{place}' of a tile that is no more")

    def function_at(self, address: int) -> str:
        """Refused."""
        raise UsageError(f"0x{address:05X} of a tile that is no more")
