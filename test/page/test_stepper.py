"""Single instructions of one tile: what its chip tells, and that nothing else changes."""

from pathlib import Path

from tilenca.base.sides import EAST, WEST
from tilenca.emulator.array import Array
from tilenca.page.stepper import Stepper

LINKS = [(0, EAST, 1, WEST), (1, EAST, 2, WEST)]


def test_stepping_changes_no_byte_of_what_comes(firmware: Path) -> None:
    """A tile of three is taken through 300 instructions and another through 50; then all go on."""
    straight, stepped = (Array(str(firmware), 3, LINKS, [100.0, -200.0, 50.0]) for _ in range(2))
    for array in (straight, stepped):
        array.run(0.15)
    stepper = Stepper(stepped)
    assert not stepper.release()
    before = stepper.tell("tile-02", stepped[1])["chip"]
    stepper.step(stepped[1], 300)
    after = stepper.tell("tile-02", stepped[1])["chip"]
    assert after["cycles"] >= before["cycles"] + 300
    stepper.step(stepped[2], 50)
    assert [tile.halted for tile in stepped] == [False, False, True]
    assert stepper.release()
    for array in (straight, stepped):
        array.run(0.25 - array.time_s)
    assert stepped.time_s == straight.time_s
    assert stepped.save() == straight.save()


def test_a_chip_tells_where_it_is_and_what_is_in_it(firmware: Path) -> None:
    array = Array(str(firmware), 1)
    array.run(0.15)
    stepper = Stepper(array)
    stepper.step(array[0], 1)
    event = stepper.tell("tile-01", array[0])
    chip = event["chip"]
    assert (event["port"], event["time"]) == ("tile-01", round(array.time_s, 6))
    assert (chip["pc"], chip["function"]) == (array[0].pc, array.function_at(array[0].pc))
    assert chip["registers"] == array[0].read_memory(0, 32).hex()
    assert (len(chip["code"]), chip["sreg"], chip["sp"]) == (8, array[0].status, array[0].stack.pointer)
    variables = {name: (address, size, data) for name, address, size, data in chip["variables"]}
    address, size, data = variables["tilenca_sending"]
    assert (0x800000 + address, size) == array.symbol("tilenca_sending")
    assert bytes.fromhex(data) == array[0].variable("tilenca_sending")[:16]
    places = [address for address, _, _ in variables.values()]
    assert places == sorted(places)
    assert len(variables) > 30
