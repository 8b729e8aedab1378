"""JSON and TOML from outside: whatever is wrong with a text is a ValueError.

The standard library's readers raise other exceptions too, for lists in lists beyond their depth and for
numbers with more digits than Python converts.
"""

import json
import tomllib
from typing import Any


def read_json(text: str, **options: Any) -> Any:
    """The value of a JSON text.

    Args:
        text: one document.
        options: of `json.loads`.

    Raises:
        ValueError: it is none, or nested too deeply.
    """
    try:
        return json.loads(text, **options)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def read_toml(text: str) -> dict[str, Any]:
    """The table of a TOML text.

    Raises:
        ValueError: it is none, nested too deeply, or has a number with too many digits.
    """
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise ValueError("nested too deeply") from None
    except ValueError:
        raise ValueError("a number has too many digits") from None
