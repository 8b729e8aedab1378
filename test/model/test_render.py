"""A model as the C++ of the firmware: the same every time, and refused where no tile could run it."""

from dataclasses import replace

import pytest

from firmware.synthetic_models import random_network
from tilenca.base.errors import BuildError
from tilenca.model import cost, render
from tilenca.model.file import Dimensions, Model

SIZE = Dimensions(5, 7, 6)


@pytest.fixture
def model() -> Model:
    return replace(random_network(SIZE, 127, seed=3), labels=("4", "b", "-"))


def test_the_same_model_renders_to_the_same_text(model: Model) -> None:
    assert render.render(model) == render.render(model)


def test_an_accumulator_that_could_wrap_is_refused(model: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    """No model file can reach 24 bits; a narrower accumulator would wrap with this one."""
    render.check_fits(model)
    monkeypatch.setattr(render, "ACCUMULATOR_MAX", 2**15 - 1)
    with pytest.raises(BuildError, match="layer 1 could add up to"):
        render.check_fits(model)


@pytest.mark.parametrize(
    ("size", "words"),
    [
        (Dimensions(52, 40, 40), "52 channels"),
        (Dimensions(21, 128, 40), "128"),
        (Dimensions(21, 40, 300), "300"),
    ],
)
def test_a_model_too_wide_for_the_firmware_is_refused(size: Dimensions, words: str) -> None:
    with pytest.raises(BuildError, match=words):
        render.check_fits(random_network(size, 9))


def test_a_weight_of_minus_128_is_refused() -> None:
    model = random_network(SIZE, 9)
    model.integer["w2"][3, 3] = -128
    with pytest.raises(BuildError, match="w2 has a weight of -128"):
        render.check_fits(model)


def test_the_widest_model_of_the_largest_weights_fits() -> None:
    size = Dimensions(51, 120, 127)
    model = random_network(size, 127)
    for name, array in model.integer.items():
        array.fill(127 if name.startswith("w") else -32768)
    render.check_fits(model)
    assert cost.flash_bytes(size, 1) == 15 * (17 + 8 * 255) + 16 * (17 + 8 * 120) + 7 * (17 + 8 * 127) + 5
