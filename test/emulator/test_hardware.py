"""What a board does not give: inputs that float, SRAM that is not empty, clocks that are off."""

import math

import pytest

from support.avr import Compile, words
from tilenca.base.errors import UsageError
from tilenca.base.paths import FIRMWARE_ELF
from tilenca.base.sides import EAST, WEST
from tilenca.emulator import IDEAL, Array, Hardware
from tilenca.emulator.serve import STOCK_BOOTLOADER

# Counts, of 4000 looks at PA0, those that saw it high, and the changes; PORTA and MCUCR are set first.
LOOK = """
int main(void) {
    uint16_t high = 0, changes = 0;
    uint8_t before = PINA & 1;
    SETUP;
    for (uint16_t n = 0; n < 4000; n++) {
        uint8_t now = PINA & 1;
        high += now; changes += now != before; before = now;
        _delay_us(10);
    }
    result16[0] = high; result16[1] = changes; result16[2] = 1;
    for (;;) { }
}
"""


def looks(elf: object, hardware: Hardware) -> list[int]:
    with Array(str(elf), hardware=hardware) as array:
        array.run(0.1)
        high, changes, done = words(array[0].read_memory(0x1000, 6))
    assert done == 1
    return [high, changes]


def test_an_input_that_nobody_drives_reads_what_the_seed_says_and_changes(avr: Compile) -> None:
    elf = avr(LOOK.replace("SETUP", ""))
    high, changes = looks(elf, Hardware(seed=1))
    assert 1000 < high < 3000
    assert changes > 100
    assert looks(elf, Hardware(seed=1)) == [high, changes]
    assert looks(elf, Hardware(seed=2)) != [high, changes]


def test_a_pull_up_lifts_it_unless_all_are_off(avr: Compile) -> None:
    lifted = avr(LOOK.replace("SETUP", "PORTA = 1; before = 1; _delay_us(1)"))
    assert looks(lifted, Hardware(seed=1)) == [4000, 0]
    off = avr(LOOK.replace("SETUP", "PORTA = 1; MCUCR = 1 << PUD"))
    assert 1000 < looks(off, Hardware(seed=1))[0] < 3000


def test_an_ideal_input_reads_high(avr: Compile) -> None:
    assert looks(avr(LOOK.replace("SETUP", "")), IDEAL) == [4000, 0]


def test_how_often_somebody_looks_changes_nothing(avr: Compile) -> None:
    elf = avr(LOOK.replace("SETUP", ""))
    with Array(elf) as once, Array(elf) as often:
        once.run(0.05)
        for _ in range(50):
            often.run(0.001)
            often[0].pin("A", 0)
        assert once.save() == often.save()


@pytest.mark.parametrize(
    ("setup", "interrupts"),
    [("", True), ("PORTK = 0x40;", False), ("PORTK = 0x40; MCUCR = 0x10;", True), ("DDRK = 0x40;", False)],
)
def test_noise_on_a_pin_interrupts(avr: Compile, setup: str, interrupts: bool) -> None:
    source = f"""
    ISR(PCINT2_vect) {{ result16[0]++; }}
    int main(void) {{
        {setup} _delay_us(1); result16[0] = 0; PCMSK2 = 0x40; PCIFR = 7; PCICR = 4; sei();
        for (;;) {{ }}
    }}"""
    with Array(avr(source)) as array:
        array.run(0.1)
        (count,) = words(array[0].read_memory(0x1000, 2))
    assert (300 < count < 2000) if interrupts else count == 0


@pytest.mark.parametrize(("setup", "receives"), [("", True), ("PORTH = 1;", False)])
def test_a_receiver_without_a_pull_up_hears_bytes_that_nobody_sends(
    avr: Compile, setup: str, receives: bool
) -> None:
    source = f"""
    int main(void) {{
        {setup} result16[0] = 0; UBRR2 = 25; UCSR2B = 0x10;
        for (;;) {{ while (!(UCSR2A & 0x80)) {{ }} (void)UDR2; result16[0]++; }}
    }}"""
    with Array(avr(source)) as array:
        array.run(0.1)
        assert (words(array[0].read_memory(0x1000, 2))[0] > 50) == receives


def test_a_timer_counts_noise_on_its_pin(avr: Compile) -> None:
    source = "int main(void) { SETUP TCCR5B = 7; for (;;) result16[0] = TCNT5; }"
    for setup, counts in (("", True), ("PORTL = 4; _delay_us(1);", False)):
        with Array(avr(source.replace("SETUP", setup))) as array:
            array.run(0.05)
            assert (words(array[0].read_memory(0x1000, 2))[0] > 50) == counts


def test_an_input_that_is_off_reads_zero(avr: Compile) -> None:
    source = """
    int main(void) {
        PORTF = PORTK = 0xFF; PORTE = 0x0C;
        DIDR0 = 0x0F; DIDR2 = 0xF0; DIDR1 = 1; _delay_us(1);
        result[0] = PINF; result[1] = PINK; result[2] = PINE & 0x0C;
        for (;;) { }
    }"""
    with Array(avr(source)) as array:
        array.run(0.001)
        assert array[0].read_memory(0x1000, 3) == bytes([0xF0, 0x0F, 0x08])


# --- tiles without power ---

LISTEN = """
int main(void) {
    PORTJ = 1; _delay_ms(10);
    uint16_t high = 0;
    for (uint16_t n = 0; n < 1000; n++) { high += PINJ & 1; _delay_us(10); }
    result16[0] = high;
    UBRR3 = 51; UCSR3A = 2; UCSR3B = 0x10;
    for (;;) { if (UCSR3A & 0x80) { result[4]++; (void)UDR3; } }
}
"""


@pytest.mark.parametrize(
    ("unpowered", "least", "most"),
    [("low", 0, 0), ("middle", 100, 900), ("high", 1000, 1000), ("open", 1000, 1000)],
)
def test_a_tile_without_power_loads_its_neighbour_s_input(
    avr: Compile, unpowered: str, least: int, most: int
) -> None:
    elf = avr(LISTEN)
    hardware = Hardware(unpowered=unpowered)
    with Array(elf, 2, [(0, EAST, 1, WEST)], hardware=hardware) as array:
        array[0].powered = False
        array.run(0.05)
        assert least <= words(array[1].read_memory(0x1000, 2))[0] <= most


def test_a_tile_that_is_not_switched_on_yet_has_no_power(avr: Compile) -> None:
    with Array(avr(LISTEN), 2, [(0, EAST, 1, WEST)], switch_on_s=[0.015, 0.0]) as array:
        array.run(0.05)
        assert 300 < words(array[1].read_memory(0x1000, 2))[0] < 700  # low until then; then it has a pull-up


def test_a_tile_that_is_taken_away_leaves_an_open_input(avr: Compile) -> None:
    with Array(avr(LISTEN), 2, [(0, EAST, 1, WEST)]) as array:
        array.remove_tile(0)
        array.run(0.05)
        assert words(array[1].read_memory(0x1000, 2)) == [1000]


def test_a_line_that_is_held_low_is_one_break(avr: Compile) -> None:
    source = """
    int main(void) {
        PORTJ = 1; UBRR3 = 51; UCSR3A = 2; UCSR3B = 0x10; result[0] = 0;
        for (;;) {
            while (!(UCSR3A & 0x80)) { }
            result[1] = UCSR3A & 0x1C; result[2] = UDR3; result[0]++;
        }
    }"""
    with Array(avr(source)) as array:
        pin = array[0].side_pin(WEST, receiving=True)
        for held, breaks in ((False, 1), (None, 1), (False, 2), (True, 2), (None, 2)):
            array.run(0.01)
            array[0].hold_pin(*pin, held)
            array.run(0.05)
            assert array[0].read_memory(0x1000, 3) == bytes([breaks, 0x10, 0])


def test_a_receiver_that_is_switched_on_while_its_line_is_low_waits_for_the_next_edge(avr: Compile) -> None:
    source = """
    int main(void) {
        PORTJ = 1; _delay_ms(5); UBRR3 = 51; UCSR3A = 2; UCSR3B = 0x10; result[0] = 0;
        for (;;) if (UCSR3A & 0x80) { (void)UDR3; result[0]++; }
    }"""
    with Array(avr(source)) as array:
        array[0].hold_pin(*array[0].side_pin(WEST, receiving=True), False)
        array.run(0.05)
        assert array[0].read_memory(0x1000, 1) == b"\0"


# --- SRAM, watchdog, start-up ---


def test_sram_holds_noise_that_differs_from_tile_to_tile_and_from_time_to_time(avr: Compile) -> None:
    elf = avr("int main(void) { for (;;) { } }")

    def contents(array: Array, tile: int) -> bytes:
        return array[tile].read_memory(0x400, 0x1000)

    with Array(elf, 2) as array, Array(elf, 2) as again, Array(elf, 1, hardware=IDEAL) as ideal:
        first = contents(array, 0)
        assert len(set(first)) > 250
        assert contents(array, 1) != first
        assert contents(again, 0) == first
        assert set(contents(ideal, 0)) == {0}
        array[0].powered = False
        array[0].powered = True
        assert contents(array, 0) != first
        kept = contents(array, 0)
        array[0].reset()
        assert contents(array, 0) == kept


def periods(elf: object, hardware: Hardware, tiles: int) -> list[float]:
    """Milliseconds from one time-out of the watchdog to the next, of each tile."""
    with Array(str(elf), tiles, hardware=hardware) as array:
        array.run(0.2)
        return [words(tile.read_memory(0x1000, 2))[0] / 15.625 for tile in array]


def test_the_watchdog_s_clock_is_off_by_the_seed(avr: Compile) -> None:
    source = """
    ISR(WDT_vect) { result16[0] = TCNT1 - result16[1]; result16[1] = TCNT1; }
    int main(void) { cli(); wdt_reset(); WDTCSR = 0x18; WDTCSR = 0x41; TCCR1B = 5; sei(); for (;;) { } }"""
    elf = avr(source)
    nominal = 4096 / 128.0
    assert periods(elf, IDEAL, 1) == pytest.approx([nominal], abs=0.1)
    found = periods(elf, Hardware(seed=4), 12)
    assert all(nominal / 1.1001 <= period <= nominal / 0.8999 for period in found)
    assert max(found) / min(found) > 1.08
    assert found == periods(elf, Hardware(seed=4), 12)


STARTED = "int main(void) { DDRB = 0x20; PORTB = 0x20; for (;;) { } }"


def started_s(array: Array, from_s: float = 0.0) -> float:
    """When PB5 rises."""
    with array:
        probe = array[0].probe("B", 5)
        array.run(0.3)
        edges = [edge.time_s for edge in probe.read() if edge.level and edge.time_s > from_s]
        return edges[-1] - from_s if edges else math.inf


# 16384 cycles, 14 more, and 8192 ticks of the watchdog's clock; or what other fuses say.
@pytest.mark.parametrize(
    ("low", "expected_s"),
    [(0xFF, (16384 + 14) / 16e6 + 0.064), (0xEF, (16384 + 14) / 16e6 + 0.004), (0xCF, 0.064), (0xDE, 0.064)],
)
def test_a_tile_takes_its_fuses_time_to_start(avr: Compile, low: int, expected_s: float) -> None:
    hardware = Hardware(start_up=True, watchdog_error=0.0, floating_inputs=False)
    array = Array(avr(STARTED), hardware=hardware)
    array[0].set_fuses(low=low)
    with array:
        seconds = 0.0
        while not array[0].duty("B", 5) and seconds < 0.3:
            array.run(16e-6)
            seconds = array.time_s
    # Setting the fuses starts it a second time.
    assert seconds == pytest.approx(expected_s + (16384 + 14) / 16e6 + 0.064, abs=0.001)


def test_without_a_bootloader_it_starts_at_once(avr: Compile) -> None:
    with Array(avr(STARTED)) as array:
        array.run(0.001)
        assert array[0].duty("B", 5) == 1


@pytest.mark.skipif(
    not STOCK_BOOTLOADER.exists(), reason="arduino-core-avr is not installed; run `make setup`"
)
@pytest.mark.parametrize(("spoken_to", "least_s", "most_s"), [(False, 0.8, 1.3), (True, 4.0, 7.0)])
def test_the_stock_bootloader_waits_a_second_or_five_after_a_byte(
    avr: Compile, spoken_to: bool, least_s: float, most_s: float
) -> None:
    with Array(avr(STARTED), bootloader=STOCK_BOOTLOADER) as array:
        if spoken_to:
            array.run(0.2)
            array[0].write_serial(b"?")
        while not array[0].read_memory(0x24, 1)[0] & 0x20 and array.time_s < 10:
            array.run(0.01)
        assert least_s < array.time_s < most_s


def test_a_snapshot_brings_its_hardware_along(avr: Compile) -> None:
    elf = avr(LOOK.replace("SETUP", ""))
    with (
        Array(elf, 2, hardware=Hardware(seed=5, unpowered="middle")) as array,
        Array(elf, hardware=IDEAL) as other,
    ):
        array.run(0.01)
        snapshot = array.save()
        array.run(0.05)
        other.restore(snapshot)
        other.run(0.05)
        assert other.save() == array.save()


@pytest.mark.parametrize("wrong", [{"unpowered": "off"}, {"watchdog_error": 0.6}, {"watchdog_error": -0.1}])
def test_hardware_that_cannot_be_is_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(
        UsageError, match=r"unpowered is one of low, middle, high, open; watchdog_error is 0 to 0\.5"
    ):
        Array(FIRMWARE_ELF, hardware=Hardware(**wrong))  # type: ignore[arg-type]
