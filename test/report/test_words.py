"""What the report says in words."""

from tilenca.report.experiments import EXPERIMENTS, TITLES
from tilenca.report.words import introductions, marks_of, why


def test_every_section_has_an_introduction() -> None:
    assert set(introductions()) == set(TITLES)


def test_words_and_marks_belong_to_experiments_that_exist() -> None:
    assert why("edges.nothing") == ""
    assert not marks_of("edges.nothing")
    from tilenca.report.words import _words

    keys = {experiment.key for experiment in EXPERIMENTS}
    assert set(_words()["why"]) <= keys
    assert {mark["figure"] for mark in _words()["marks"]} <= keys
    assert any(mark.value is None for mark in marks_of("edges.dead"))
    assert any(mark.value is not None for mark in marks_of("edges.dead"))
