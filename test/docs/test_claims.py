"""The README claims what the report has measured, row by row."""

import pytest

from docs.claims import CLAIM, README, RESULTS, filled, measured


def test_every_number_of_the_readme_that_links_to_a_row_is_its_value() -> None:
    text, values = README.read_text(encoding="utf-8"), measured(RESULTS.read_text(encoding="utf-8"))
    assert len(CLAIM.findall(text)) >= 30
    assert len(values) >= 200
    assert filled(text, values) == text


def test_another_number_is_put_right_and_a_row_that_is_none_is_named() -> None:
    values = measured('| <a id="a.b@60"></a>two tiles, after 60 updates | 0.750 | 0.5 to 0.9 | 4 |  |\n')
    assert values == {"a.b@60": "0.750"}
    assert (
        filled("so [1.0](docs/RESULTS.md#a.b@60) it is", values) == "so [0.750](docs/RESULTS.md#a.b@60) it is"
    )
    with pytest.raises(KeyError, match=r"a\.c"):
        filled("[1.0](docs/RESULTS.md#a.c)", values)
