"""The displays of emulated tiles, and a verdict on them."""

from tilenca.emulator.experiment import Emulation
from tilenca.shapes.file import UNKNOWN, Task
from tilenca.views.tiles import Picture


def take_picture(emulation: Emulation) -> Picture:
    """A picture of all displays, read from the tiles' pins."""
    tiles = list(emulation.array)
    return Picture(emulation.shape, tuple(t.segments for t in tiles), tuple(t.rgb for t in tiles))


def verdict(emulation: Emulation) -> str:
    """One line: whether the tiles are right, and since when."""
    name, standing = emulation.shape.name, [tile for tile in emulation.array if tile.powered]
    count = len(standing)
    agreed_s, after_update_s = emulation.agreed_at_s(), emulation.agreed_after_update_s()
    if agreed_s is not None:
        updated = "" if after_update_s is None else f", {after_update_s:.2f} s after its first update"
        tiles = "the tile shows" if count == 1 else f"all {count} tiles show"
        return (
            f"{name}: {tiles} {emulation.shape.label}, since {agreed_s:.2f} s after the last was switched on"
            f"{updated} (update {emulation.agreed_at_update()})"
        )
    wrong = [
        f"tile {tile.index + 1} {emulation.shown(tile) or 'nothing'}"
        for tile in standing
        if emulation.shown(tile) != emulation.shape.label
    ]
    model = f" with model {emulation.hello.model_id:04X}" if emulation.hello else ""
    total = f"{len(wrong)} of {count} tiles do not show {emulation.shape.label}{model}"
    return f"{name}: WRONG, {total}: {', '.join(wrong)}"


def mismatch(emulation: Emulation, task: Task) -> str | None:
    """The remedy if wrong tiles run a model of other shapes; None without a sign of that."""
    hello = emulation.hello
    foreign = {emulation.shown(tile) for tile in emulation.array} - {"", UNKNOWN, *task.labels}
    classes = len(task.labels), len({*task.labels, UNKNOWN})
    if hello is None or emulation.all_right or (hello.classes in classes and not foreign):
        return None
    return (
        f"the firmware's model {hello.model_id:04X} is not for {task.path} ({' '.join(task.labels)}); export "
        "the model trained on that file and build: tilenca export --model DIR && pio run"
    )
