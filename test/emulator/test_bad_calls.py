"""Every function of the emulator's C interface that is called with what cannot be, and says so."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from support.avr import hex_record
from support.emulator_calls import TILES, World, other_bad_calls, tile_calls


@pytest.fixture(scope="module")
def image(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A program that loops at its first instruction."""
    path = tmp_path_factory.mktemp("image") / "loop.hex"
    path.write_text(hex_record(0, 0, bytes.fromhex("ffcf")) + hex_record(1, 0, b""))
    return str(path).encode()


@pytest.fixture(scope="module")
def world(image: bytes) -> Iterator[World]:
    world = World(image)
    yield world
    world.lib.tilenca_array_free(world.array)


# They cannot fail: null is allowed, or nothing is given.
SAFE = {"array_free", "emulator_abi_version", "emulator_size_of", "emulator_last_error"}


def fails(w: World, function: str, arguments: tuple[Any, ...]) -> None:
    """Makes the call, which must fail with words of its own."""
    assert not w.lib.tilenca_side_pin(0, 0, w.ffi.new("char*"), w.ffi.new("unsigned*"))
    before = set_other_error(w)
    result = getattr(w.lib, f"tilenca_{function}")(*arguments)
    shown = f"{function}{arguments} returned {result}"
    if isinstance(result, w.ffi.CData):
        assert result == w.null, shown
    else:
        assert result < 0, shown
    words = w.library.last_error()
    assert words != before, f"{shown} and said nothing"
    assert words, f"{shown} and said nothing"
    assert "\n" not in words


def set_other_error(w: World) -> str:
    """Leaves words that no call of the tests would."""
    assert w.lib.tilenca_array_symbol(w.array, b"of another call", w.words, w.words) < 0
    return w.library.last_error()


def test_no_function_is_left_out(world: World) -> None:
    everything = {name.removeprefix("tilenca_") for name in dir(world.lib) if name.startswith("tilenca_")}
    assert everything == SAFE | set(tile_calls(world)) | set(other_bad_calls(world))


def test_a_tile_that_does_not_exist(world: World) -> None:
    for function, rest in tile_calls(world).items():
        for tile in (TILES, TILES + 1, 2**31, 2**32 - 1):
            fails(world, function, (world.array, tile, *rest))


def test_no_array(world: World) -> None:
    for function, rest in tile_calls(world).items():
        fails(world, function, (world.null, 0, *rest))


def test_all_else_that_cannot_be(world: World) -> None:
    for function, calls in other_bad_calls(world).items():
        for arguments in calls:
            fails(world, function, arguments)


def test_the_array_is_none_the_worse(image: bytes) -> None:
    world, untouched = World(image), World(image)
    for function, calls in other_bad_calls(world).items():
        for arguments in calls:
            if function != "array_load":  # after which an array may be of no use
                fails(world, function, arguments)
    for each in (world, untouched):
        assert each.lib.tilenca_array_run(each.array, 0.01) == 0
    assert saved(world) == saved(untouched)


def saved(w: World) -> bytes:
    start = w.ffi.new("uint8_t*[1]")
    count = w.lib.tilenca_array_save(w.array, start)
    return bytes(w.ffi.buffer(start[0], count))


def test_a_side_pin_is_that_of_the_side(world: World) -> None:
    port, bit = world.ffi.new("char*"), world.ffi.new("unsigned*")
    found = []
    for side in range(4):
        for receives in (0, 1):
            assert world.lib.tilenca_side_pin(side, receives, port, bit) == 0
            found.append((port[0] + str(bit[0]).encode()).decode())
    assert found == ["H1", "H0", "D3", "D2", "K7", "K6", "J1", "J0"]


def test_threads_that_the_machine_does_not_give_are_an_error_and_no_end(image: bytes, tmp_path: Path) -> None:
    """In a process of its own, which may use little more memory than it has."""
    script = tmp_path / "few_threads.py"
    script.write_text(
        "import resource, sys\n"
        "from tilenca.base import native_library\n"
        "library = native_library.load('emulator')\n"
        "lib, ffi = library.lib, library.ffi\n"
        "array = lib.tilenca_array_new(sys.argv[1].encode(), ffi.NULL, 2, [0.0] * 2, [0.0] * 2)\n"
        "pages = int(open('/proc/self/statm').read().split()[0])\n"
        "limit = pages * resource.getpagesize() + 64 * 2**20\n"
        "resource.setrlimit(resource.RLIMIT_AS, (limit, limit))\n"
        "assert lib.tilenca_array_set_threads(array, 1024) < 0\n"
        "print(library.last_error())\n"
        "assert lib.tilenca_array_run(array, 0.001) == 0\n"
    )
    command = [sys.executable, str(script), image.decode()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    assert "esource" in done.stdout or "memory" in done.stdout
