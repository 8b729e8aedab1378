"""Whether a network fits, said before it is trained."""

import subprocess
from itertools import pairwise
from pathlib import Path

import pytest

from firmware import stack
from firmware.disassembly import disassemble, parse
from firmware.elf import Firmware
from tilenca.base import paths
from tilenca.base.errors import BuildError, UsageError
from tilenca.model import cost, packing, render
from tilenca.model.file import Dimensions, load_model
from tilenca.protocol.constants import DEFAULT_PERIOD_MS

WIDEST = Dimensions(51, 127, 127)  # of the buffers; a first layer that wide is refused
WIDE = Dimensions(51, 120, 127)


def test_flash_is_what_the_exported_arrays_take() -> None:
    model = load_model(paths.DEFAULT_MODEL)
    said = cost.flash_bytes(model.dimensions, len(model.labels))
    streams = sum(len(part.stream) for layer in (1, 2, 3) for part in packing.blocks(model, layer))
    assert said == streams + cost.LOOK_BYTES * len(model.labels)
    symbols = {symbol.name: symbol.size for symbol in Firmware(paths.FIRMWARE_ELF).flash_data()}
    assert sum(size for name, size in symbols.items() if "model" in name and "kModel" not in name) == said


def test_sram_is_about_what_the_built_firmware_takes() -> None:
    measured = Firmware(paths.FIRMWARE_ELF).sram_bytes + stack.worst_case(
        parse(disassemble(paths.FIRMWARE_ELF))
    )
    said = cost.estimate(Dimensions(), 10, 100).sram_bytes
    assert abs(said - measured) < 0.05 * measured, (
        f"OTHER_SRAM_BYTES of fit.py: {measured - said} more or less"
    )


def size_on_the_chip(folder: Path, size: Dimensions) -> int:
    """Bytes of a tile, and of the bits of a frame, in a firmware whose widest network is `size`."""
    network = (paths.FIRMWARE / "include" / "core" / "network.h").read_text(encoding="utf-8")
    folder.joinpath("core").mkdir(parents=True)
    narrowed = network.replace("kMaxChannels = 51", f"kMaxChannels = {size.channels}").replace(
        "kMaxHidden = 127", f"kMaxHidden = {size.hidden1}"
    )
    folder.joinpath("core", "network.h").write_text(narrowed, encoding="utf-8")
    source = '#include "app/tile.h"\n#include "core/toggles.h"\nusing namespace tilenca;\n'
    source += "char probe[sizeof(Tile) + kMaxToggleBytes];\nint main() { return probe[0]; }\n"
    folder.joinpath("probe.cpp").write_text(source, encoding="utf-8")
    compiler = [
        "avr-g++",
        "-mmcu=atmega2560",
        "-std=gnu++14",
        f"-I{folder}",
        f"-I{paths.FIRMWARE / 'include'}",
    ]
    subprocess.run([*compiler, "-o", "probe.elf", "probe.cpp"], cwd=folder, check=True)
    (probe,) = [symbol for symbol in Firmware(folder / "probe.elf").symbols if symbol.name == "probe"]
    return probe.size


@pytest.mark.parametrize("size", [Dimensions(21, 40, 40), Dimensions(3, 5, 5)], ids=str)
def test_the_buffers_shrink_with_the_widths_as_counted(tmp_path: Path, size: Dimensions) -> None:
    shrunk = size_on_the_chip(tmp_path / "widest", WIDEST) - size_on_the_chip(tmp_path / "narrow", size)
    assert shrunk == cost.WIDEST_BUFFERS - cost.buffer_bytes(size)


def test_what_is_wider_costs_more() -> None:
    fits = [
        cost.estimate(Dimensions(*size), 10, 100) for size in ((12, 24, 24), (21, 40, 40), (51, 127, 127))
    ]
    for narrow, wide in pairwise(fits):
        assert narrow.flash_bytes < wide.flash_bytes
        assert narrow.update_cycles < wide.update_cycles
        assert narrow.shortest_period_ms < wide.shortest_period_ms


def test_the_shortest_period_leaves_head_room() -> None:
    for size in (Dimensions(), Dimensions(37, 64, 64), WIDE):
        period_ms = cost.shortest_period_ms(size)
        assert cost.estimate(size, 10, period_ms).load <= 1 - cost.HEAD_ROOM
        assert cost.estimate(size, 10, period_ms - 1).load > 1 - cost.HEAD_ROOM


def test_no_period_is_shorter_than_its_frames() -> None:
    """51 channels are 60 bytes on the wire, 15.6 ms at 38,400 baud, however little there is to compute."""
    assert cost.frame_bytes(51) == 60
    assert cost.shortest_period_ms(Dimensions(51, 1, 1)) >= 60 * 10 / 38.4 / (1 - cost.HEAD_ROOM)


def test_nothing_is_faster_than_the_firmwares_shortest_period() -> None:
    assert cost.shortest_period_ms(Dimensions(2, 1, 1)) == 10


def test_the_period_is_that_of_platformio_ini(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert cost.firmware_period_ms() == 20
    monkeypatch.setattr(paths, "PROJECT", tmp_path)
    with pytest.raises(BuildError, match=r"platformio\.ini: no build_flags"):
        cost.firmware_period_ms()
    ini = tmp_path / "platformio.ini"
    ini.write_text("[env:megaatmega2560]\nbuild_flags = -D OTHER=1\n", encoding="utf-8")
    with pytest.raises(BuildError, match="names no period"):
        cost.firmware_period_ms()
    ini.write_text("[env:megaatmega2560]\nbuild_flags = -D TILENCA_PERIOD_MS=77 -D X\n", encoding="utf-8")
    assert cost.firmware_period_ms() == 77


def test_the_default_period_is_the_one_that_platformio_ini_builds() -> None:
    assert cost.firmware_period_ms() == DEFAULT_PERIOD_MS


def test_a_check_is_one_line_for_people() -> None:
    line = str(cost.check(Dimensions(37, 40, 40), 26))
    assert line.startswith("fits a tile: 10,985 bytes of flash")


def test_more_classes_than_channels_are_refused() -> None:
    with pytest.raises(UsageError, match="26 classes need a state of at least 27 channels"):
        cost.check(Dimensions(21, 40, 40), 26)
    with pytest.raises(UsageError):
        cost.check(Dimensions(), 0)


def test_weights_that_outgrow_the_flash_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cost, "MAX_FLASH_BYTES", 6_000)
    model = load_model(paths.DEFAULT_MODEL)
    taken = cost.flash_bytes(model.dimensions, len(model.labels))
    with pytest.raises(BuildError, match=f"{taken} bytes of weights, the firmware has room for 6000"):
        render.check_fits(load_model(paths.DEFAULT_MODEL))


def test_a_layer_larger_than_the_compiler_takes_is_refused() -> None:
    cost.check(WIDE, 26)
    with pytest.raises(BuildError, match="a layer of 32912 bytes, the compiler takes 32767"):
        cost.check(WIDEST, 26)
