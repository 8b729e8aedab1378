"""A file for the EEPROM of each emulated tile: the settings that tiles keep between two runs."""

from pathlib import Path

from tilenca.base.errors import UsageError
from tilenca.base.whole_file import write_whole
from tilenca.emulator.tile import EEPROM_BYTES, EmulatedTile
from tilenca.emulator.types import port_name

EEPROM_SUFFIX = ".eeprom"


def load_eeprom(tile: EmulatedTile, directory: Path) -> bool:
    """Puts a tile's file into its EEPROM; False if it has none.

    Raises:
        UsageError: the file cannot be read, or is not as long as the EEPROM.
    """
    path = _path(tile, directory)
    try:
        contents = path.read_bytes()
    except FileNotFoundError:
        return False
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; give --eeprom a directory of such files") from error
    if len(contents) != EEPROM_BYTES:
        raise UsageError(
            f"{path}: {len(contents)} bytes, an EEPROM has {EEPROM_BYTES}; delete it to begin anew"
        )
    tile.write_eeprom(0, contents)
    return True


def save_eeprom(tile: EmulatedTile, directory: Path) -> None:
    """Writes a tile's EEPROM to its file; all of it or nothing.

    Raises:
        UsageError: the directory cannot be written.
    """
    path, remedy = _path(tile, directory), "give --eeprom a directory that can be written"
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"{directory}: {error.strerror}; {remedy}") from error
    write_whole(path, tile.read_eeprom(), remedy, UsageError)


def _path(tile: EmulatedTile, directory: Path) -> Path:
    return directory / f"{port_name(tile.index)}{EEPROM_SUFFIX}"
