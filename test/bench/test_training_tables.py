"""The tables of docs/TRAINING.md and the shipped models' cards are what their metrics say."""

from bench import training_tables


def test_tables_and_cards_are_those_of_the_metrics() -> None:
    documents = training_tables.documents()
    assert len(documents) > 5
    for path, text in documents.items():
        assert path.read_text(encoding="utf-8") == text, f"{path}: run tools/bench/training_tables.py"
