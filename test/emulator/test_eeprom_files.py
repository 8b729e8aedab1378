"""What emulated tiles remember between two runs, in files."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from support.emulate import emulate, report
from support.refusal import read_or_refused
from support.strategies import damaged
from tilenca.base.errors import UsageError
from tilenca.base.paths import FIRMWARE_ELF
from tilenca.emulator import Array, EmulatedTile
from tilenca.emulator.eeprom_files import load_eeprom, save_eeprom
from tilenca.emulator.tile import EEPROM_BYTES


@pytest.fixture
def tile() -> Iterator[EmulatedTile]:
    with Array(FIRMWARE_ELF) as array:
        yield array[0]


def test_what_was_saved_is_there_again(tile: EmulatedTile, tmp_path: Path) -> None:
    tile.write_eeprom(100, b"remember me")
    save_eeprom(tile, tmp_path / "new" / "folder")
    files = list((tmp_path / "new" / "folder").iterdir())
    assert [file.name for file in files] == ["tile-01.eeprom"]
    assert files[0].stat().st_size == EEPROM_BYTES
    tile.write_eeprom(100, b"something e")
    assert load_eeprom(tile, tmp_path / "new" / "folder")
    assert tile.read_eeprom()[100:111] == b"remember me"


def test_without_a_file_the_tile_is_as_new(tile: EmulatedTile, tmp_path: Path) -> None:
    assert not load_eeprom(tile, tmp_path)
    assert not load_eeprom(tile, tmp_path / "nowhere")
    assert set(tile.read_eeprom()) == {0xFF}


@pytest.mark.parametrize("size", [0, EEPROM_BYTES - 1, EEPROM_BYTES + 1])
def test_a_file_of_another_length_is_refused_and_changes_nothing(
    tile: EmulatedTile, tmp_path: Path, size: int
) -> None:
    (tmp_path / "tile-01.eeprom").write_bytes(bytes(size))
    with pytest.raises(UsageError, match=rf"tile-01\.eeprom: {size} bytes, .* delete it to begin anew"):
        load_eeprom(tile, tmp_path)
    assert set(tile.read_eeprom()) == {0xFF}


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    damaged(bytes(range(256)) * (EEPROM_BYTES // 256))
    | st.binary(min_size=EEPROM_BYTES, max_size=EEPROM_BYTES)
)
def test_any_bytes_are_the_eeprom_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, tile: EmulatedTile, content: bytes
) -> None:
    """What the firmware makes of them is another matter: it has checksums of its own."""
    path, before = tmp_path_factory.mktemp("fuzz") / "tile-01.eeprom", tile.read_eeprom()
    loaded = read_or_refused(path, content, lambda path: load_eeprom(tile, path.parent))
    assert tile.read_eeprom() == (content if loaded else before)
    save_eeprom(tile, path.parent)
    assert path.read_bytes() == tile.read_eeprom()
    assert [path.name for path in path.parent.iterdir()] == ["tile-01.eeprom"]


def test_a_place_that_is_no_folder_is_told_with_the_remedy(tile: EmulatedTile, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(UsageError, match="give --eeprom a directory of such files"):
        load_eeprom(tile, tmp_path / "file")
    with pytest.raises(UsageError, match="give --eeprom a directory that can be written"):
        save_eeprom(tile, tmp_path / "file")


def test_an_eeprom_outlives_the_run(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    directory = tmp_path / "eeprom"
    report(capsys, "--seconds", "0.2", "--period-ms", "250", "--eeprom", directory)
    files = sorted(path.name for path in directory.iterdir())
    assert files == [f"tile-0{n}.eeprom" for n in range(1, 6)]
    assert all((directory / name).stat().st_size == 4096 for name in files)
    # The period of the first run is still there.
    slow = report(
        capsys, "--seconds", "3", "--boot-spread", "0", "--bootloader", "none", "--eeprom", directory
    )
    assert all(tile["updates"] in (11, 12) for tile in slow["tiles"])
    (directory / "tile-03.eeprom").write_bytes(b"short")
    status, _, err = emulate(capsys, "--eeprom", directory)
    assert (status, err.count("\n")) == (2, 1)
    assert "tile-03.eeprom: 5 bytes, an EEPROM has 4096; delete it" in err
