"""The displays of emulated tiles, and the verdict on them."""

from pathlib import Path

from tilenca.base.paths import DEFAULT_SHAPES, FIRMWARE_ELF
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.greeting import firmware_settings
from tilenca.shapes.file import Shape, load_task
from tilenca.shapes.glyphs import look_of
from tilenca.views.emulated import NOT_YET, RIGHT, WRONG, judge, mismatch, take_picture, verdict

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
    assert judge(emulation, 1000) == RIGHT
    assert mismatch(emulation, TASK) is None
    look = look_of("1", 1)
    picture = take_picture(emulation)
    assert picture.shape == one
    assert set(picture.segments) == {look.segments}
    assert set(picture.colours) == {look.colour}


def test_tiles_that_show_something_else_are_counted_and_listed_if_wanted() -> None:
    four_called_one = Shape("1", TASK.find("4").rows, "1")
    emulation = emulated(four_called_one)
    count = len(four_called_one.cells)
    assert emulation.hello is not None
    words = f"1: WRONG, 0 of {count} tiles show 1, {count} show 4; model {emulation.hello.model_id:04X}"
    assert verdict(emulation) == f"{words}; -v lists them"
    assert verdict(emulation, every=True).startswith(f"{words}: tile 1 shows 4, tile 2 shows 4")
    assert f"{words} is models/mine; -v lists them" in verdict(emulation, place="models/mine")
    assert judge(emulation, 0) == WRONG
    assert mismatch(emulation, TASK) is None, "the model is for these drawings"


def test_tiles_that_have_not_had_their_time_are_not_wrong_yet() -> None:
    emulation = emulated(Shape("1", TASK.find("4").rows, "1"), seconds=0.5)
    done = emulation.fewest_updates()
    assert 0 < done < 60
    assert judge(emulation, done) == WRONG
    assert judge(emulation, 60) == NOT_YET
    assert verdict(emulation, 60) == (
        f"1: not yet, 0 of 10 tiles show 1, 10 show 4 after {done} updates; such a drawing may take 60: "
        "run on, with --updates 60"
    )


def test_before_their_first_update_tiles_are_not_wrong_yet() -> None:
    emulation = emulated(TASK.find("1"), seconds=0.001)
    assert set(take_picture(emulation).segments) == {0}
    assert "1: not yet, 5 of 5 tiles have done no update (a bootloader takes the first second)" in verdict(
        emulation, 60
    )
    assert verdict(emulation, 60, every=True).endswith("tile 4 shows nothing, tile 5 shows nothing")


def test_tiles_that_a_fault_sets_apart_are_named() -> None:
    emulation = emulated(TASK.find("1"), seconds=0.001)
    emulation.faults.plug(1, False)
    assert emulation.faults.parts() == [[2, 3, 4], [0]]
    assert verdict(emulation, every=True).endswith(
        "; tile 2 without power; tile 1 is joined to no other: it answers for itself"
    )
    emulation.faults.plug(3, False)
    assert emulation.faults.parts() == [[0], [2], [4]]


def test_a_model_of_other_shapes_is_told_with_the_remedy() -> None:
    emulation = emulated(Shape("1", TASK.find("4").rows, "1"))
    letters = load_task(DEFAULT_SHAPES.with_name("letters.toml"))
    remedy = mismatch(emulation, letters)
    assert remedy is not None
    assert f"is not for {letters.path}" in remedy
    assert remedy.endswith(
        f"; make one that is: tilenca make {letters.path} (--force, if it made another one)"
    )
    remedy = mismatch(emulation, letters, Path("models/no such"))
    assert str(remedy).endswith(
        "tilenca export --model 'models/no such' --build, then tilenca emulate --model 'models/no such'"
    )
