"""One drawing on emulated tiles, to its end."""

from dataclasses import replace
from pathlib import Path

import pytest

from tilenca.base import paths
from tilenca.base.errors import BuildError
from tilenca.emulator.experiment import EmulationSettings
from tilenca.emulator.fault_spec import FaultSpec, parse
from tilenca.emulator.greeting import firmware_settings
from tilenca.model.file import load_model
from tilenca.shapes.file import Shape
from tilenca.simulator.simulator import MIXED
from tilenca.sweep.emulated import Image, plugged, run_emulated

pytestmark = pytest.mark.skipif(
    not paths.FIRMWARE_ELF.exists(), reason="run `make setup` to build the firmware"
)
BAR = Shape("1", ("#", "#", "#"), "1")
SETTINGS = EmulationSettings(updates=20, boot_spread_s=0.1)


@pytest.fixture(scope="module")
def image() -> Image:
    elf = paths.FIRMWARE_ELF
    return Image(elf, firmware_settings(elf), load_model(paths.DEFAULT_MODEL), Path("models/digits"))


def test_a_run_that_ends_well(image: Image) -> None:
    looks: list[int] = []
    run = run_emulated(image, BAR, SETTINGS, lambda running, heard: looks.append(len(heard)))
    assert (run.right, run.answer) == (1.0, 1)
    assert 1 <= run.converged_at <= 20
    assert 60 <= run.updates <= 90
    assert sum(looks) > 20
    assert run_emulated(image, BAR, SETTINGS) == run


def test_tiles_without_power_are_not_asked(image: Image) -> None:
    run = run_emulated(image, BAR, replace(SETTINGS, faults=(parse("off@1"),)))
    assert run.updates < 50
    assert run.right in (0.0, 0.5, 1.0)


def test_without_messages_tiles_differ_or_are_wrong_together(image: Image) -> None:
    run = run_emulated(
        image, Shape("4", ("#.#", "###", "..#"), "4"), replace(SETTINGS, faults=(parse("loss=1"),))
    )
    assert run.right < 1
    assert run.answer == MIXED or run.answer != 4


def test_an_image_with_another_model_is_refused_with_the_remedy(image: Image) -> None:
    other = replace(image, model=load_model(paths.MODELS / "digits-40"), source=Path("given.elf"))
    with pytest.raises(BuildError) as caught:
        run_emulated(other, BAR, SETTINGS)
    ours, theirs = f"{image.model.model_id:04X}", f"{other.model.model_id:04X}"
    assert str(caught.value) == (
        f"given.elf: carries model {ours}, not {theirs}; run: tilenca export --model models/digits && pio run"
    )


def test_a_tile_that_is_plugged_in_counts_from_there(image: Image) -> None:
    for kind, away_s, back_s in (("again", 1.2, 2.0), ("new", 0.0, 1.2)):
        settings = plugged(SETTINGS, kind, 3, 20, 20)
        (fault,) = settings.faults
        assert isinstance(fault, FaultSpec)
        assert (fault.kind, fault.from_s, fault.to_s) == ("off", away_s, back_s)
        assert 1 <= int(fault.where) <= 3
        assert settings.seconds == pytest.approx(back_s + 0.2 + 21 * 0.02)
        run = run_emulated(image, BAR, settings)
        assert run.right == 1.0
        assert 0.1 < run.agreed_s < 0.6
        assert 1 <= run.converged_at <= 20
    tiles = {str(plugged(replace(SETTINGS, seed=seed), "new", 3, 20, 20).faults[0]) for seed in range(20)}
    assert len(tiles) == 3
