"""The cases that the tests of both twins of the protocol run, in C++ and here."""

import re

from tilenca.base import paths

VECTORS = paths.ROOT / "test" / "vectors"


def cases(name: str) -> list[tuple[str, ...]]:
    """The `CASE(...)` lines of a shared file; each argument as text, quotes removed."""
    lines = re.findall(r"^CASE\((.*)\)$", (VECTORS / name).read_text(), flags=re.MULTILINE)
    return [
        tuple(re.sub(r'^"|"$', "", part) for part in re.findall(r'"[^"]*"|[^", ]+', line)) for line in lines
    ]
