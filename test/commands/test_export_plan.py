"""tilenca export --plan: what widths would cost."""

import json

import pytest

from tilenca.cli import main
from tilenca.model import cost
from tilenca.model.file import Dimensions

WIDE = Dimensions(51, 120, 127)


def plan(*arguments: str) -> int:
    try:
        return main(["export", "--plan", *arguments])
    except SystemExit as ended:
        return int(ended.code or 0)


def test_a_plan_as_text_and_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert plan("--state", "37", "--hidden", "40", "--classes", "26") == 0
    text = capsys.readouterr().out
    assert text.startswith("5 x 37 -> 40 -> 40 -> 37, 26 classes, 10,480 multiplications\n")
    assert plan("--state", "37", "--hidden", "40", "--classes", "26", "--json") == 0
    document = json.loads(capsys.readouterr().out)
    assert document == cost.check(Dimensions(37, 40, 40), 26).as_json()
    assert document["fits"] is True
    assert f"{document['flash_bytes']:,} bytes" in text
    assert f"{document['shortest_period_ms']} ms" in text


def test_a_plan_is_of_the_default_widths_with_all_classes(capsys: pytest.CaptureFixture[str]) -> None:
    assert plan("--json") == 0
    assert json.loads(capsys.readouterr().out) == cost.check(Dimensions(), 20).as_json()


def test_a_plan_too_slow_for_the_period_fails_and_names_one(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cost, "firmware_period_ms", lambda: 20)
    assert str(cost.check(WIDE, 26)).startswith("fits a tile's memory, but not its period")
    assert plan("--state", "51", "--hidden", "120", "--json") == 1
    said = capsys.readouterr()
    document = json.loads(said.out)
    assert document["fits"] is False
    assert said.err.count("\n") == 1
    assert f"TILENCA_PERIOD_MS={document['shortest_period_ms']}" in said.err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--plan", "--state", "12", "--classes", "12"], "at least 13 channels"),
        (["--plan", "--state", "1"], "'1' is not a whole number from 2 to 51"),
        (["--plan", "--hidden", "128"], "'128' is not a whole number from 1 to 127"),
        (["--plan", "--classes", "0"], "'0' is not a whole number from 1 to 50"),
        (["--state", "30"], "--state: a trained model has its widths; add --plan"),
        (["--plan", "--check"], "--plan writes nothing"),
    ],
)
def test_a_plan_that_makes_no_sense(
    arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    try:
        status = main(["export", *arguments])
    except SystemExit as ended:
        status = int(ended.code or 0)
    said = capsys.readouterr()
    assert status == 2
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert words in said.err
