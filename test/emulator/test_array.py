"""Many tiles: lockstep, cables, switching on, and the same results whatever the slicing."""

import pytest

from support.avr import Compile
from support.avr import IdealArray as Array
from tilenca.base.errors import UsageError
from tilenca.base.sides import EAST, WEST
from tilenca.emulator import EmulatedTile
from tilenca.emulator.array import CABLE_DELAY_S
from tilenca.emulator.library import call

# Passes on what comes from the west, plus one, to the east; the first tile of a row starts it.
BUCKET_BRIGADE = """
ISR(USART3_RX_vect) {
    uint8_t c = UDR3;
    result[0]++; result[1] = result[1] * 31 + c;
    PORTH = c << 3;
    UDR1 = c + 1;
}
int main(void) {
    result[0] = result[1] = 0;
    DDRH = 0x78;
    UBRR1 = UBRR3 = 16; UCSR1A = UCSR3A = 2; UCSR1B = 8; UCSR3B = 0x90;
    set_sleep_mode(SLEEP_MODE_IDLE); sei();
    for (uint8_t n = 0;; n++) {
        if (eeprom_read_byte(0) == 1) { _delay_us(777); UDR1 = n; } else sleep_mode();
    }
}
"""


def build(elf: object, cable_delay_s: float = CABLE_DELAY_S) -> Array:
    links = [(tile, EAST, tile + 1, WEST) for tile in range(4)]
    ppm, on = [2500.0, -1000.0, 0.0, 300.0, -2999.0], [0.0, 0.003, 0.001, 0.0005, 0.002]
    array = Array(str(elf), 5, links, ppm, on, cable_delay_s=cable_delay_s)
    array[0].write_eeprom(0, b"\x01")
    return array


def everything(tile: EmulatedTile) -> tuple[object, ...]:
    return tile.cycles, tile.pc, tile.read_memory(0, 0x2200), tile.segments, tile.display_changes


def test_bytes_pass_through_a_row_of_tiles(avr: Compile) -> None:
    array = build(avr(BUCKET_BRIGADE))
    array.run(0.2)
    counts = [tile.read_memory(0x1000, 1)[0] for tile in array]
    assert counts[0] == 0
    assert all(
        count >= 240 for count in counts[1:]
    )  # of 257, less what was sent before they were switched on


def test_bytes_are_the_same_whatever_a_cable_takes(avr: Compile) -> None:
    two_hundred = BUCKET_BRIGADE.replace("UDR1 = n; }", "if (n < 200) UDR1 = n; }")
    heard = []
    for delay_s in (20e-6, 68e-6, 260e-6):
        array = build(avr(two_hundred), delay_s)
        array.run(0.19)
        heard.append([tile.read_memory(0x1000, 2) for tile in array])
    assert heard[0][4][0] in range(190, 201)
    assert heard[1:] == heard[:1] * 2


def test_a_cable_takes_what_it_took_when_the_array_began(avr: Compile) -> None:
    array = build(avr(BUCKET_BRIGADE))
    array.run(0.001)
    with pytest.raises(UsageError, match="keep their delay once the array runs"):
        call("array_set_cable_delay", array.handle, 20e-6)
    with pytest.raises(UsageError, match="delay in ticks"):
        build(avr(BUCKET_BRIGADE), 19e-6)


@pytest.mark.parametrize("delay_s", [20e-6, 68e-6, 91e-6, 260e-6])
def test_results_do_not_depend_on_how_time_is_sliced(avr: Compile, delay_s: float) -> None:
    elf = avr(BUCKET_BRIGADE)
    whole, sliced = build(elf, delay_s), build(elf, delay_s)
    whole.run(0.1001)
    for _ in range(331):
        sliced.run(0.1001 / 331)
    assert [everything(tile) for tile in whole] == [everything(tile) for tile in sliced]


def test_the_same_calls_give_the_same_bytes(avr: Compile) -> None:
    elf = avr(BUCKET_BRIGADE)
    first, second = build(elf), build(elf)
    first.run(0.1)
    second.run(0.1)
    assert [everything(tile) for tile in first] == [everything(tile) for tile in second]


def test_clocks_and_switch_on_times_are_the_tiles_own(avr: Compile) -> None:
    with Array(
        avr("int main(void) { for (;;) { } }"), 3, ppm=[0, 3000, -3000], switch_on_s=[0, 0.25, 2]
    ) as array:
        array.run(1.0)
        cycles = [tile.cycles[0] for tile in array]
    assert abs(cycles[0] - 16_000_000) < 10
    assert abs(cycles[1] - 12_036_000) < 10
    assert cycles[2] == 0


def test_what_a_tile_says_is_stamped_with_its_time(avr: Compile) -> None:
    source = """
    int main(void) {
        UBRR0 = 16; UCSR0A = 2; UCSR0B = 8;
        for (;;) { _delay_ms(10); UDR0 = 'x'; }
    }"""
    array = Array(avr(source), switch_on_s=[0.5])
    array.run(0.6)
    times = array[0].read_serial_timed()[1]
    assert len(times) == 9
    assert abs(times[0] - 0.5101) < 0.0002


def test_the_board_is_wired_as_the_pin_map_says(avr: Compile) -> None:
    source = """
    int main(void) {
        DDRH = 0x78; DDRE = 0x08; DDRB = 0xC0; DDRG = 0x20; DDRK = 0x0F;
        PORTH = 1 << 4 | 1 << 3; PORTG = 1 << 5; PORTK = 0x05;       /* a, b, dp; LEDs of N and S */
        while (PINF & 1) { }
        PORTH = 0; PORTG = 0; PORTE = 1 << 3; PORTB = 1 << 7 | 1 << 6; PORTK = 0x0A;   /* c, d, e */
        for (;;) { }
    }"""
    array = Array(avr(source))
    array.run(0.001)
    assert array[0].segments == 0b1000_0011
    assert array[0].leds == (True, False, True, False)
    array[0].press_button()
    array.run(0.001)
    assert array[0].leds == (True,) * 4, "eyes still see those of before"
    array.run(0.02)
    assert array[0].segments == 0b0001_1100
    assert array[0].leds == (False, True, False, True)
    assert array[0].display_changes[0].segments == 0b1000_0011


def test_what_is_closed_or_gone_says_so(avr: Compile) -> None:
    array = build(avr(BUCKET_BRIGADE))
    before = array.save()
    added = array.add_tile()
    array.restore(before)
    with pytest.raises(UsageError, match="it is no more"):
        added.read_serial()
    with pytest.raises(UsageError, match="no more"):
        added.mark("main")
    probe = array[0].probe("H", 3)
    array.close()
    for use in (lambda: array.run(1), lambda: array[0].pc, lambda: array.time_s, probe.read, array.save):
        with pytest.raises(UsageError, match="the array is closed"):
            use()
    array.close()  # once more does no harm
