"""A tile that an array no longer has is refused in words."""

from collections.abc import Callable

import pytest

from tilenca.base.errors import UsageError
from tilenca.emulator.home import Nowhere


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda home: home.handle, "came after the moment that was restored"),
        (lambda home: home.symbol("counter"), "'counter' of a tile that is no more"),
        (lambda home: home.code_address("main"), "'main' of a tile that is no more"),
        (lambda home: home.function_at(0x1A2), "0x001A2 of a tile that is no more"),
    ],
)
def test_whatever_is_asked_is_refused(ask: Callable[[Nowhere], object], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        ask(Nowhere())
