"""What an emulated tile tells of itself."""

from tilenca.emulator.types import SRAM_END, Stack, port_name


def test_a_stack_grows_down_from_the_end_of_memory() -> None:
    assert Stack(pointer=SRAM_END - 10, deepest=SRAM_END - 300, floor=0x400).most_bytes == 300
    assert Stack(pointer=SRAM_END, deepest=SRAM_END, floor=0x200).most_bytes == 0


def test_ports_count_from_one_and_sort_as_their_tiles() -> None:
    names = [port_name(index) for index in range(99)]
    assert (names[0], names[19], names[98]) == ("tile-01", "tile-20", "tile-99")
    assert names == sorted(names)
    assert port_name(99) == "tile-100"
