"""JSON and TOML of any text: a value, or a ValueError."""

import contextlib
import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from support.strategies import damaged
from tilenca.base.parsing import read_json, read_toml

WRONG = r"nested too deeply|digits"
documents = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


@given(documents)
def test_a_document_is_read_as_it_was_written(document: object) -> None:
    assert read_json(json.dumps(document)) == document


@given(damaged(b'{"a": [1, 2.5, {"b": null}], "c": "d"}'))
def test_any_other_text_is_a_value_error(content: bytes) -> None:
    text = content.decode("utf-8", "replace")
    with contextlib.suppress(ValueError):
        read_json(text)
    with contextlib.suppress(ValueError):
        assert isinstance(read_toml(text), dict)


@pytest.mark.parametrize("text", ["[" * 5000, "9" * 5000])
def test_what_never_ends_is_a_value_error(text: str) -> None:
    with pytest.raises(ValueError, match=WRONG):
        read_json(text)
    with pytest.raises(ValueError, match=WRONG):
        read_toml(f"a = {text}")
