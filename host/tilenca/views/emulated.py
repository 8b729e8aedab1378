"""The displays of emulated tiles, and a verdict on them."""

import shlex
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from tilenca.base import paths
from tilenca.emulator.experiment import Emulation
from tilenca.protocol.sentences import HelloSentence
from tilenca.shapes.file import UNKNOWN, Task
from tilenca.views.tiles import Picture, shown_by

RIGHT, NOT_YET, WRONG = "right", "not yet", "wrong"


def take_picture(emulation: Emulation) -> Picture:
    """A picture of all displays, read from the tiles' pins."""
    tiles = list(emulation.array)
    return Picture(emulation.shape, tuple(t.segments for t in tiles), tuple(t.rgb for t in tiles))


def judge(emulation: Emulation, expected: int) -> str:
    """Whether the tiles are `right`, or `not yet`, since they have not had their time, or `wrong`.

    Args:
        emulation: that has ended.
        expected: the updates in which the tiles of such a drawing may agree.
    """
    if emulation.all_right:
        return RIGHT
    return NOT_YET if emulation.fewest_updates() < expected else WRONG


def verdict(emulation: Emulation, expected: int = 0, every: bool = False, place: str | None = None) -> str:
    """One line: whether the tiles are right, and since when.

    Args:
        emulation: that has ended.
        expected: see `judge`.
        every: list each tile that shows something else, and those that a fault sets apart.
        place: of the firmware's model, if that is known.
    """
    name, standing = emulation.shape.name, [tile for tile in emulation.array if tile.powered]
    count = len(standing)
    agreed_s, after_update_s = emulation.agreed_at_s(), emulation.agreed_after_update_s()
    if agreed_s is not None:
        updated = "" if after_update_s is None else f", {after_update_s:.2f} s after its first update"
        powered = " with power" if count < len(emulation.array) else ""
        tiles = f"the tile{powered} shows" if count == 1 else f"all {count} tiles{powered} show"
        return (
            f"{name}: {tiles} {emulation.shape.label}, since {agreed_s:.2f} s after the last was switched on"
            f"{updated} (update {emulation.agreed_at_update()})"
        )
    shown = counted(emulation)
    if judge(emulation, expected) == NOT_YET:
        done, late = emulation.fewest_updates(), emulation.without_update()
        since = f"{shown} after {done} updates"
        if late:
            since = f"{late} of {count} tiles have done no update (a bootloader takes the first second)"
        text = (
            f"{name}: not yet, {since}; such a drawing may take {expected}: run on, with --updates {expected}"
        )
    else:
        model = f"; model {emulation.hello.model_id:04X}" if emulation.hello else ""
        model += f" is {place}" if model and place else ""
        text = f"{name}: WRONG, {shown}{model}{'' if every else '; -v lists them'}"
    if every:
        other = [tile for tile in standing if emulation.shown(tile) != emulation.shape.label]
        text += f": {', '.join(f'tile {t.index + 1} shows {_word(emulation.shown(t))}' for t in other)}"
        text += "".join(f"; {part}" for part in _faults(emulation))
    return text


def _faults(emulation: Emulation) -> Iterator[str]:
    """The tiles without power, and those that no cable joins to the largest part."""
    off = [tile.index for tile in emulation.array if not tile.powered]
    if off:
        yield f"tile{'s' * (len(off) > 1)} {_numbers(off)} without power"
    for part in emulation.faults.parts()[1:]:
        if len(part) == 1:
            yield f"tile {_numbers(part)} is joined to no other: it answers for itself"
        else:
            yield f"tiles {_numbers(part)} are joined to each other only: a part that answers for itself"


def _numbers(tiles: Sequence[int]) -> str:
    return ", ".join(str(tile + 1) for tile in tiles)


def counted(emulation: Emulation) -> str:
    """How many tiles show what, like `26 of 28 tiles show 4, 2 show a dash`."""
    answers = Counter(emulation.answers())
    right = answers.pop(emulation.shape.label, 0)
    first = f"{right} of {right + answers.total()} tiles show {emulation.shape.label}"
    others = shown_by((_word(label), count) for label, count in answers.most_common())
    return f"{first}, {others}" if others else first


def _word(label: str) -> str:
    return {"": "nothing", UNKNOWN: "a dash"}.get(label, label)


def mismatch(emulation: Emulation, task: Task, trained: Path | None = None) -> str | None:
    """The remedy if wrong tiles run a model of other shapes; None without a sign of that.

    `trained` is the folder of a model of these shapes, if there is one.
    """
    hello = emulation.hello
    foreign = {emulation.shown(tile) for tile in emulation.array} - {"", UNKNOWN, *task.labels}
    classes = len(task.labels), len({*task.labels, UNKNOWN})
    if hello is None or emulation.all_right or (hello.classes in classes and not foreign):
        return None
    return foreign_firmware(hello, task, trained)


def foreign_firmware(hello: HelloSentence, task: Task, trained: Path | None = None) -> str:
    """What to say of a firmware that was made for other drawings; `trained`: see `mismatch`."""
    fact = f"the firmware's model {hello.model_id:04X} is not for {task.path} ({' '.join(task.labels)})"
    if trained is None:
        again = f"tilenca make {shlex.quote(str(task.path))}"
        return f"{fact}; make one that is: {again} (--force, if it made another one)"
    place = shlex.quote(str(trained))
    first = "" if paths.model_elf(trained).exists() else f"tilenca export --model {place} --build, then "
    return f"{fact}; take the one that is: {first}tilenca emulate --model {place}"
