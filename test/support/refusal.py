"""How a model is refused."""

from pathlib import Path

import pytest

from tilenca.base.errors import UsageError
from tilenca.model.file import load_model


def refusal(model: Path) -> str:
    with pytest.raises(UsageError) as caught:
        load_model(model)
    message = str(caught.value)
    assert "\n" not in message
    return message
