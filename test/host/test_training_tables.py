"""The tables of docs/TRAINING.md are what the shipped models' metrics say."""

import training_tables


def test_the_tables_are_those_of_the_metrics() -> None:
    text = training_tables.DOCUMENT.read_text(encoding="utf-8")
    assert training_tables.rendered(text) == text, "run tools/training_tables.py"
