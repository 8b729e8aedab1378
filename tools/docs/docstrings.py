"""Where docstrings and signatures of this project need help on their way into Sphinx.

Colons: Google's style lets a docstring's first line, and that of `Returns:`, begin with a type and a colon.
This project writes types as annotations only, so there a colon is part of the sentence. It is hidden while
napoleon works.
"""

import importlib
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from sphinx.application import Sphinx

HIDDEN_COLON = "\ue000"  # of the private use area: no text has it
BEFORE_NAPOLEON, AFTER_NAPOLEON = 400, 600
ATTRIBUTES = {"attribute", "data", "property"}
SECTIONS = {"Returns:", "Yields:"}


def hide_colons(kind: str, lines: list[str]) -> None:
    """Hides the colons that napoleon would take for the end of a type; changes `lines`.

    Args:
        kind: autodoc's word for what is documented, such as "property".
        lines: the docstring.
    """
    prose = {0} if kind in ATTRIBUTES else set()
    prose |= {number + 1 for number, line in enumerate(lines) if line.strip() in SECTIONS}
    for number in prose & set(range(len(lines))):
        lines[number] = lines[number].replace(":", HIDDEN_COLON)


def show_colons(lines: list[str]) -> None:
    """Puts the hidden colons back; changes `lines`."""
    lines[:] = [line.replace(HIDDEN_COLON, ":") for line in lines]


def valid_signature(signature: str) -> str:
    """A signature that Sphinx can parse: what a field's factory makes is written as `...`."""
    return signature.replace("<factory>", "...")


def is_type_variable(target: str) -> bool:
    """Whether a full name is that of a type variable, which has no entry that a reference could lead to."""
    module, _, name = target.rpartition(".")
    try:
        return isinstance(getattr(importlib.import_module(module), name, None), TypeVar)
    except (ImportError, ValueError):
        return False


def setup(app: "Sphinx") -> dict[str, bool]:
    """Listens to autodoc before and after napoleon does."""

    def before(_app: object, kind: str, _name: str, _object: Any, _options: Any, lines: list[str]) -> None:
        hide_colons(kind, lines)

    def after(_app: object, _kind: str, _name: str, _object: Any, _options: Any, lines: list[str]) -> None:
        show_colons(lines)

    def sign(
        _app: object, _kind: str, _name: str, _object: Any, _options: Any, signature: str | None, returns: Any
    ) -> tuple[str | None, Any]:
        return (None if signature is None else valid_signature(signature)), returns

    def missing(_app: object, _environment: object, node: Any, content: Any) -> Any:
        return content if is_type_variable(node.get("reftarget", "")) else None

    app.connect("autodoc-process-signature", sign)
    app.connect("missing-reference", missing)
    app.connect("autodoc-process-docstring", before, priority=BEFORE_NAPOLEON)
    app.connect("autodoc-process-docstring", after, priority=AFTER_NAPOLEON)
    return {"parallel_read_safe": True}
