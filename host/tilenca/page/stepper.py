"""Single instructions of one tile, as a debugger takes them, and what is in its chip."""

from tilenca.emulator.array import Array
from tilenca.emulator.gdb import REGISTERS, STACK_POINTER
from tilenca.emulator.tile import DATA_SPACE, EmulatedTile
from tilenca.emulator.types import SRAM_END
from tilenca.protocol.stream import StreamEvent, chip_event

SRAM_START = 0x200
MOST_BYTES = 16  # of a variable, and of the stack
CODE_BYTES = 4  # of the longest instruction


class Stepper:
    """Halts one tile of an array at a time, between two of its instructions; the others wait for it."""

    def __init__(self, array: Array) -> None:
        self._array = array
        self._halted: EmulatedTile | None = None
        self._variables: list[tuple[str, int, int]] | None = None

    def step(self, tile: EmulatedTile, count: int) -> None:
        """Executes so many instructions, as far as the tile does not sleep on for a second."""
        for _ in range(count):
            if self._halted is not tile:
                self.release()
                tile.halt()
                self._halted = tile
            if not tile.step():
                return

    def release(self) -> bool:
        """Lets the halted tile go on with the next run of the array; returns whether there was one."""
        if self._halted is None:
            return False
        self._halted.resume()
        self._halted = None
        return True

    def tell(self, port: str, tile: EmulatedTile) -> StreamEvent:
        """What is in a tile's chip."""
        stack = int.from_bytes(tile.read_memory(STACK_POINTER, 2), "little")
        above = max(0, min(MOST_BYTES, SRAM_END - stack - 1))
        return chip_event(
            self._array.time_s,
            port,
            {
                "pc": tile.pc,
                "function": tile.function,
                "code": tile.read_flash(tile.pc, CODE_BYTES).hex(),
                "registers": tile.read_memory(0, REGISTERS).hex(),
                "sreg": tile.status,
                "sp": stack,
                "stack": tile.read_memory(stack + 1, above).hex(),
                "cycles": tile.cycles[0],
                "variables": [
                    [name, address, size, tile.read_memory(address, min(size, MOST_BYTES)).hex()]
                    for name, address, size in self._known()
                ],
            },
        )

    def _known(self) -> list[tuple[str, int, int]]:
        """The image's variables in SRAM: name, address and bytes, in order of address."""
        if self._variables is None:
            self._variables = []
            address = SRAM_START
            while address < SRAM_END:
                name = self._array.function_at(DATA_SPACE + address)
                begin, size = self._array.symbol(name) if name else (DATA_SPACE + address, 1)
                if name and begin == DATA_SPACE + address:
                    self._variables.append((name, address, size))
                address = max(address + 1, begin - DATA_SPACE + size)
        return self._variables
