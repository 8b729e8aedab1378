"""Sleep modes, power reduction, the clock prescaler, resets, and power itself."""

import pytest

from support.avr import Compile, words
from support.avr import IdealArray as Array
from tilenca.emulator import ResetCause

# Sleeps in MODE while timer 1 counts cycles; a pin change on PK7 wakes it.
SLEEPER = """
ISR(PCINT2_vect) { }
int main(void) {
    result16[0] = 0xFFFF;
    PCMSK2 = 0x80; PCICR = 4; TCCR1B = 5;          /* 1024 cycles a count */
    set_sleep_mode(MODE); sei();
    sleep_mode();
    result16[0] = TCNT1;
    for (;;) { }
}
"""


@pytest.mark.parametrize(
    ("mode", "counted_s", "start_s"),
    [
        ("SLEEP_MODE_IDLE", 0.2, 0.0),
        ("SLEEP_MODE_ADC", 0.0, 0.0),
        ("SLEEP_MODE_PWR_DOWN", 0.0, 16384 / 16e6),
        ("SLEEP_MODE_PWR_SAVE", 0.0, 16384 / 16e6),
        ("SLEEP_MODE_STANDBY", 0.0, 0.0),
        ("SLEEP_MODE_EXT_STANDBY", 0.0, 0.0),
    ],
)
def test_clocks_stand_in_every_mode_but_idle(
    avr: Compile, mode: str, counted_s: float, start_s: float
) -> None:
    array = Array(avr(SLEEPER, f"-DMODE={mode}"))
    array.run(0.2)
    array[0].hold_pin("K", 7, False)
    array.run(start_s + 0.0001 if start_s else 0.0001)
    (counted,) = words(array[0].read_memory(0x1000, 2))
    assert counted * 1024 / 16e6 == pytest.approx(counted_s, abs=0.001)
    assert array[0].sleep_share > 0.98


def test_the_crystal_takes_its_time_to_come_up(avr: Compile) -> None:
    array = Array(avr(SLEEPER, "-DMODE=SLEEP_MODE_PWR_DOWN"))
    array.run(0.01)
    array[0].hold_pin("K", 7, False)
    array.run(0.0009)
    assert words(array[0].read_memory(0x1000, 2)) == [0xFFFF]
    array.run(0.0002)
    assert words(array[0].read_memory(0x1000, 2)) != [0xFFFF]


@pytest.mark.parametrize(("mode", "woken"), [("SLEEP_MODE_IDLE", 1), ("SLEEP_MODE_PWR_DOWN", 0)])
def test_edges_of_int4_are_not_seen_without_a_clock(avr: Compile, mode: str, woken: int) -> None:
    source = f"""
    ISR(INT4_vect) {{ result[0] = 1; }}
    int main(void) {{
        result[0] = 0; EICRB = 2; EIMSK = 0x10; set_sleep_mode({mode}); sei();
        for (;;) sleep_mode();
    }}"""
    array = Array(avr(source))
    array.run(0.001)
    array[0].hold_pin("E", 4, False)
    array.run(0.01)
    assert array[0].read_memory(0x1000, 1)[0] == woken


def test_the_watchdog_wakes_from_power_down(avr: Compile) -> None:
    source = """
    ISR(WDT_vect) { result[0]++; }
    int main(void) {
        result[0] = 0; cli(); WDTCSR = 0x18; WDTCSR = 0x40;     /* 16 ms */
        set_sleep_mode(SLEEP_MODE_PWR_DOWN); sei();
        for (;;) sleep_mode();
    }"""
    array = Array(avr(source))
    array.run(0.17)
    # The watchdog runs on while the crystal starts: 16 ms each.
    assert array[0].read_memory(0x1000, 1)[0] in (10, 11)
    assert array[0].sleep_share > 0.99


def test_noise_reduction_sleep_starts_a_conversion_that_ends_it(avr: Compile) -> None:
    source = """
    ISR(ADC_vect) { result[2] = 1; }
    int main(void) {
        result[2] = 0; ADMUX = 0x42; ADCSRA = 0x8F; set_sleep_mode(SLEEP_MODE_ADC); sei();
        sleep_mode();
        result16[0] = ADC;
        for (;;) { }
    }"""
    array = Array(avr(source))
    array[0].set_analog(2, 345)
    array.run(0.001)
    assert words(array[0].read_memory(0x1000, 2)) == [345]
    assert array[0].read_memory(0x1002, 1) == b"\x01"


def test_what_power_reduction_has_stopped_cannot_be_written(avr: Compile) -> None:
    source = """
    int main(void) {
        OCR1A = 5; ADMUX = 3; UBRR2 = 7; SPCR = 1; TWCR = 0x41;
        PRR0 = 0xEF; PRR1 = 0x3F;
        OCR1A = 6; ADMUX = 4; UBRR2 = 8; SPCR = 2; TWCR = 0; TCCR3A = 0xFF;
        PRR0 = 0; PRR1 = 0;
        result[0] = OCR1A; result[1] = ADMUX; result[2] = UBRR2; result[3] = SPCR; result[4] = TWCR;
        result[5] = TCCR3A; TCCR3A = 0xFF; result[6] = TCCR3A;
        for (;;) { }
    }"""
    array = Array(avr(source))
    array.run(0.001)
    assert array[0].read_memory(0x1000, 7) == bytes([5, 3, 7, 1, 0x41, 0, 0xFF])


def test_power_reduction_stops_what_it_names(avr: Compile) -> None:
    source = """
    int main(void) {
        TCCR1B = 1; TCCR3B = 1; TCCR5B = 1;
        PRR0 = 0x08; uint16_t one = TCNT1;                      /* timer 1 */
        PRR1 = 0x08; uint16_t three = TCNT3;                    /* timer 3 */
        uint16_t five = TCNT5;
        _delay_us(100);
        result16[0] = TCNT1 - one; result16[1] = TCNT3 - three; result16[2] = TCNT5 - five;
        PRR0 = 0; PRR1 = 0;
        one = TCNT1; _delay_us(100); result16[3] = TCNT1 - one;
        for (;;) { }
    }"""
    array = Array(avr(source))
    array.run(0.001)
    stood_one, stood_three, ran, runs_again = words(array[0].read_memory(0x1000, 8))
    assert (stood_one, stood_three) == (0, 0)
    assert ran in range(1600, 1630)
    assert runs_again in range(1600, 1630)


def test_a_transmitter_without_clock_sends_later(avr: Compile) -> None:
    source = """
    int main(void) {
        UBRR0 = 16; UCSR0A = 2; UCSR0B = 8; UDR0 = 'a';
        PRR0 = 2; _delay_ms(5); result[0] = UCSR0A & 0x40; PRR0 = 0; _delay_ms(1); result[1] = UCSR0A & 0x40;
        for (;;) { }
    }"""
    array = Array(avr(source))
    array.run(0.01)
    assert array[0].read_memory(0x1000, 2) == bytes([0, 0x40])


@pytest.mark.parametrize("divisor", [1, 4, 256])
def test_the_clock_prescaler_slows_everything_but_the_watchdog(avr: Compile, divisor: int) -> None:
    source = f"""
    int main(void) {{
        uint8_t cause = MCUSR; MCUSR = 0;
        if (cause & 8) {{ result[3] = 1; wdt_disable(); for (;;) {{ }} }}
        result[3] = 0;
        CLKPR = 0x80; CLKPR = {divisor.bit_length() - 1};
        result[2] = CLKPR;
        wdt_enable(WDTO_30MS);
        TCCR1B = 1;
        for (;;) result16[0] = TCNT1;
    }}"""
    array = Array(avr(source))
    array.run(0.002)
    (counted,) = words(array[0].read_memory(0x1000, 2))
    assert counted == pytest.approx(32_000 / divisor, abs=0.02 * 32_000 / divisor + 40)
    assert array[0].read_memory(0x1002, 2) == bytes([divisor.bit_length() - 1, 0])
    array.run(0.025)
    assert array[0].read_memory(0x1003, 1) == b"\x00"
    array.run(0.010)
    assert array[0].read_memory(0x1003, 1) == b"\x01"


def test_the_prescaler_needs_its_change_enabled_first(avr: Compile) -> None:
    array = Array(avr("int main(void) { CLKPR = 3; result[0] = CLKPR; for (;;) { } }"))
    array.run(0.001)
    assert array[0].read_memory(0x1000, 1) == b"\x00"


@pytest.mark.parametrize("cause", list(ResetCause))
def test_a_reset_tells_its_cause(avr: Compile, cause: ResetCause) -> None:
    array = Array(avr("int main(void) { result[0] = MCUSR; MCUSR = 0; for (;;) { } }"))
    array.run(0.001)
    assert array[0].read_memory(0x1000, 1) == b"\x01"
    array[0].reset(cause)
    array.run(0.001)
    assert array[0].read_memory(0x1000, 1)[0] == cause


def test_without_power_time_passes_and_sram_forgets(avr: Compile) -> None:
    source = """
    int main(void) {
        result[1] = MCUSR; MCUSR = 0;
        DDRB = 0xFF; PORTB = 0xFF; DDRK = 1; PORTK = 1;
        if (result[0] == 0) eeprom_update_byte(0, eeprom_read_byte(0) + 1);
        result[0] = 99;
        for (;;) { }
    }"""
    array = Array(avr(source))
    array.run(0.1)
    assert array[0].leds[0]
    array[0].powered = False
    array.run(0.1)
    assert not array[0].powered
    assert not array[0].leds[0]
    assert array[0].cycles[0] == pytest.approx(1_600_000, abs=20)
    assert array[0].read_memory(0x1000, 1) == b"\x00"
    array[0].powered = True
    array.run(0.1)
    assert array[0].read_memory(0x1000, 2) == bytes([99, 1])
    assert array[0].read_eeprom(0, 1) == b"\x01"  # 0xFF, then 0x00, then 0x01
    assert array[0].cycles[0] == pytest.approx(3_200_000, abs=40)


def test_a_tile_whose_watchdog_cannot_be_switched_off(avr: Compile) -> None:
    source = "int main(void) { result[0] = MCUSR; wdt_disable(); for (;;) { } }"
    array = Array(avr(source))
    array[0].set_fuses(high=0xC9)  # WDTON
    array.run(0.020)
    assert array[0].read_memory(0x1000, 1) == b"\x09"
