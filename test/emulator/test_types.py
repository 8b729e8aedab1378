"""What an emulated tile tells of itself."""

from tilenca.emulator.types import SRAM_END, DisplayChange, Stack, last_begun, port_name


def test_a_stack_grows_down_from_the_end_of_memory() -> None:
    assert Stack(pointer=SRAM_END - 10, deepest=SRAM_END - 300, floor=0x400).most_bytes == 300
    assert Stack(pointer=SRAM_END, deepest=SRAM_END, floor=0x200).most_bytes == 0


def test_ports_count_from_one_and_sort_as_their_tiles() -> None:
    names = [port_name(index) for index in range(99)]
    assert (names[0], names[19], names[98]) == ("tile-01", "tile-20", "tile-99")
    assert names == sorted(names)
    assert port_name(99) == "tile-100"


def test_a_display_last_began_to_show_something_when_it_changed_to_it() -> None:
    changes = [DisplayChange(*one) for one in ((0.1, 6), (0.2, 91), (0.3, 6), (0.4, 6))]
    assert last_begun(changes, lambda lit: lit == 6) == 0.3, "what it shows already does not begin again"
    assert last_begun(changes, lambda lit: lit == 91) == 0.2
    assert last_begun(changes, lambda lit: lit == 7) == 0.0
