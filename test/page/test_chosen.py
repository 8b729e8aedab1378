"""A page chooses a model: its firmware is found, or built first, and a build that fails is told once."""

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from tilenca.base.errors import BuildError, UsageError
from tilenca.page.chosen import ChosenSource, ModelOffer
from tilenca.page.offer import load_offer
from tilenca.protocol import stream_commands as commands

LIMIT_S = 60
OFFER = load_offer()
OPEN = commands.Open(((0, 0), (0, 1)), speed=0.0, spread_s=0.0)


class Shop:
    """Two models of one firmware: one that is there, and one that is built when it is asked for."""

    def __init__(self, firmware: Path) -> None:
        self.firmware, self.built, self.fails = firmware, 0, False
        self.takes_long, self.begun = False, threading.Event()
        self.models = [
            ModelOffer("digits", 0xD968, OFFER, lambda: firmware, self.build),
            ModelOffer("mine", 0xBEEF, OFFER, self.find, self.build),
        ]

    def find(self) -> Path | None:
        return self.firmware if self.built else None

    def build(self, cancelled: threading.Event) -> Path:
        if self.takes_long:
            self.begun.set()
            assert cancelled.wait(LIMIT_S)
            raise BuildError("the build was cancelled")
        if self.fails:
            raise BuildError("there is no compiler")
        self.built += 1
        return self.firmware


@pytest.fixture
def shop(firmware: Path) -> Shop:
    return Shop(firmware)


@pytest.fixture
def mine(shop: Shop) -> Iterator[ChosenSource]:
    source = ChosenSource(shop.models, "BEEF")
    yield source
    source.close()


@pytest.mark.parametrize(
    ("wanted", "model"), [("", "digits"), ("mine", "mine"), ("BEEF", "mine"), ("none", "digits")]
)
def test_it_is_chosen_by_name_or_id_and_the_first_is_the_usual_one(
    shop: Shop, wanted: str, model: str
) -> None:
    shop.built = 1
    [first] = ChosenSource(shop.models, wanted).begin()
    assert first["model"] == model
    assert [(one["name"], one["id"]) for one in first["models"]] == [("digits", "D968"), ("mine", "BEEF")]
    assert first["source"] == "emulated"


def test_firmware_that_is_not_there_is_built_and_then_the_tiles_run(shop: Shop, mine: ChosenSource) -> None:
    [first] = mine.begin()
    assert (first["source"], first["takes"], first["model"]) == ("building", ["seen"], "mine")
    with pytest.raises(UsageError, match="mine is not built yet"):
        mine.take(OPEN)
    assert not mine.is_idle
    [again] = mine.advance(0.0)
    assert (again["source"], shop.built) == ("emulated", 1)
    mine.take(OPEN)
    assert any("place" in event for event in mine.advance(0.01))
    other = ChosenSource(shop.models, "mine")
    assert other.begin()[0]["source"] == "emulated"
    assert shop.built == 1, "once for all pages"


def test_a_build_that_fails_is_told_once_and_not_tried_again(shop: Shop, mine: ChosenSource) -> None:
    shop.fails = True
    mine.begin()
    [failed] = mine.advance(0.0)
    assert (failed["source"], failed["model"], failed["reason"]) == ("failed", "mine", "there is no compiler")
    assert [one["name"] for one in failed["models"]] == ["digits", "mine"], "the way back"
    assert mine.is_idle
    assert mine.advance(0.0) == []


def test_who_goes_ends_its_build_and_does_not_wait_for_that_of_others(shop: Shop) -> None:
    shop.takes_long = True
    first, second = ChosenSource(shop.models, "mine"), ChosenSource(shop.models, "mine")
    threads = [threading.Thread(target=source.advance, args=(0.0,)) for source in (first, second)]
    threads[0].start()
    assert shop.begun.wait(LIMIT_S)
    threads[1].start()
    second.abandon()
    threads[1].join(LIMIT_S)
    assert [thread.is_alive() for thread in threads] == [True, False]
    first.abandon()
    threads[0].join(LIMIT_S)
    assert not threads[0].is_alive()
    assert first.advance(0.0) == []
