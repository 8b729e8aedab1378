"""The facts of an AVR ELF file that the budgets need."""

from dataclasses import dataclass
from pathlib import Path

from elftools.common.exceptions import ELFError
from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection

# avr-gcc gives data addresses of the ELF this offset, to tell the chip's two memories apart.
DATA_SPACE = 0x800000
EEPROM_SPACE = 0x810000


@dataclass(frozen=True)
class Symbol:
    """A named piece of the program. `address` and `size` are in bytes."""

    name: str
    address: int
    size: int
    is_data: bool


class Firmware:
    """One ELF file, read once.

    Attributes:
        flash: all bytes that are programmed into flash, in order, from address 0.
        sram_bytes: SRAM taken by variables.
        symbols: named functions and variables, in both memories.
    """

    def __init__(self, path: Path) -> None:
        """Reads the file.

        Raises:
            OSError: it cannot be read.
            ValueError: it is not an ELF file for an AVR.
        """
        with path.open("rb") as stream:
            try:
                elf = ELFFile(stream)
            except ELFError as error:
                raise ValueError(f"{path}: not an ELF file ({error})") from error
            if elf["e_machine"] != "EM_AVR":
                raise ValueError(f"{path}: built for {elf['e_machine']}, not for an AVR")
            self.flash = _flash_image(elf)
            self.sram_bytes = sum(
                section["sh_size"]
                for section in elf.iter_sections()
                if section["sh_flags"] & 2 and DATA_SPACE <= section["sh_addr"] < EEPROM_SPACE
            )
            self.symbols = _symbols(elf)

    def flash_data(self) -> list[Symbol]:
        """The constants that the program reads from flash."""
        return [symbol for symbol in self.symbols if symbol.is_data and symbol.address < DATA_SPACE]


def _flash_image(elf: ELFFile) -> bytes:
    image = bytearray()
    for segment in elf.iter_segments("PT_LOAD"):
        start = segment["p_paddr"]
        if start < DATA_SPACE and segment["p_filesz"]:
            image.extend(b"\xff" * (start - len(image)))
            image[start : start + segment["p_filesz"]] = segment.data()
    return bytes(image)


def _symbols(elf: ELFFile) -> list[Symbol]:
    table = elf.get_section_by_name(".symtab")
    entries = table.iter_symbols() if isinstance(table, SymbolTableSection) else ()
    return [
        Symbol(entry.name, entry["st_value"], entry["st_size"], entry["st_info"]["type"] == "STT_OBJECT")
        for entry in entries
        if entry.name and entry["st_shndx"] != "SHN_UNDEF" and entry["st_info"]["type"] != "STT_FILE"
    ]
