"""The displays of emulated tiles, and the verdict on them."""

from tilenca.base.paths import DEFAULT_SHAPES, FIRMWARE_ELF
from tilenca.emulator.experiment import Emulation, EmulationSettings, firmware_settings
from tilenca.shapes.file import Shape, load_task
from tilenca.shapes.glyphs import look_of
from tilenca.views.emulated import mismatch, take_picture, verdict

TASK = load_task(DEFAULT_SHAPES)


def emulated(shape: Shape, seconds: float = 1.0) -> Emulation:
    settings = EmulationSettings(seconds=seconds, boot_spread_s=0.0)
    emulation = Emulation(shape, TASK.labels, FIRMWARE_ELF, settings, firmware_settings(FIRMWARE_ELF))
    emulation.run(lambda one, heard: None)
    return emulation


def test_tiles_that_agree_are_right_and_look_as_their_class() -> None:
    one = TASK.find("1")
    emulation = emulated(one)
    assert verdict(emulation).startswith("1: all 5 tiles show 1, since ")
    assert mismatch(emulation, TASK) is None
    look = look_of("1", 1)
    picture = take_picture(emulation)
    assert picture.shape == one
    assert set(picture.segments) == {look.segments}
    assert set(picture.colours) == {look.colour}


def test_tiles_that_show_something_else_are_listed_with_the_model() -> None:
    four_called_one = Shape("1", TASK.find("4").rows, "1")
    emulation = emulated(four_called_one)
    count = len(four_called_one.cells)
    assert emulation.hello is not None
    words = f"1: WRONG, {count} of {count} tiles do not show 1 with model {emulation.hello.model_id:04X}: "
    assert verdict(emulation).startswith(words)
    assert "tile 1 4, tile 2 4" in verdict(emulation)
    assert mismatch(emulation, TASK) is None, "the model is for these drawings"


def test_before_they_are_switched_on_tiles_show_nothing() -> None:
    emulation = emulated(TASK.find("1"), seconds=0.001)
    assert set(take_picture(emulation).segments) == {0}
    assert "tile 1 nothing" in verdict(emulation)


def test_a_model_of_other_shapes_is_told_with_the_remedy() -> None:
    emulation = emulated(Shape("1", TASK.find("4").rows, "1"))
    letters = load_task(DEFAULT_SHAPES.with_name("letters.toml"))
    remedy = mismatch(emulation, letters)
    assert remedy is not None
    assert f"is not for {letters.path}" in remedy
    assert remedy.endswith("tilenca export --model DIR && pio run")
