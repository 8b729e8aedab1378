"""The README claims what the report has measured, row by row."""

import shlex
from pathlib import Path

import pytest

from docs.claims import AGAIN, CARDS, CLAIM, README, RESULTS, filled, measured, unsourced, without_a_command
from tilenca import cli


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


def test_every_other_share_of_the_readme_has_a_source_in_its_line() -> None:
    assert unsourced(README.read_text(encoding="utf-8")) == []
    section = "## What was measured\n\n{}\n\n## Next\n"
    assert unsourced(section.format("names 0.35 of [0.9](docs/RESULTS.md#a.b)")) == [
        "0.35 in 'names 0.35 of [0.9](docs/RESULTS.md#a.b)'"
    ]
    for line in (
        "0.35 ([how](docs/TRAINING.md#x))",
        "version 0.1.0",
        "takes 0.5 s",
        "[1.0](docs/RESULTS.md#a)",
    ):
        assert unsourced(section.format(line)) == [], line
    with pytest.raises(ValueError, match="no section"):
        unsourced("# Nothing")


def test_every_model_s_card_has_the_command_of_its_numbers_and_the_command_exists(tmp_path: Path) -> None:
    assert without_a_command(CARDS) == []
    for card in sorted(CARDS.glob("*/README.md")):
        (command,) = AGAIN.findall(card.read_text(encoding="utf-8"))
        _, *words = shlex.split(command.replace(" DIR ", f" {card.parent} "))
        assert cli.build_parser(words[0]).parse_args(words).suite
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / "README.md").write_text("names 0.9")
    assert without_a_command(tmp_path) == [str(tmp_path / "one" / "README.md")]
