"""Timers against the data sheet: periods, flags, PWM duty, to the cycle."""

from itertools import pairwise

import pytest

from support.avr import Compile, words
from support.avr import IdealArray as Array
from tilenca.emulator import EmulatedTile


def run(elf: object, seconds: float = 0.05) -> EmulatedTile:
    array = Array(str(elf))
    array.run(seconds)
    return array[0]


MEASURE = """
ISR(VECTOR) { uint16_t now = TCNT5; static uint8_t n; if (n < 4) result16[n++] = now; }
int main(void) { TCCR5B = 1; SETUP; sei(); for (;;) { } }
"""


@pytest.mark.parametrize(
    ("vector", "setup", "period"),
    [
        ("TIMER0_OVF_vect", "TCCR0A = 3; TCCR0B = 3; TIMSK0 = 1", 64 * 256),
        ("TIMER0_OVF_vect", "TCCR0A = 1; TCCR0B = 2; TIMSK0 = 1", 8 * 510),
        ("TIMER0_COMPA_vect", "TCCR0A = 2; OCR0A = 99; TCCR0B = 2; TIMSK0 = 2", 8 * 100),
        ("TIMER0_COMPB_vect", "OCR0B = 17; TCCR0A = 3; TCCR0B = 2; TIMSK0 = 4", 8 * 256),
        ("TIMER2_OVF_vect", "TCCR2A = 3; TCCR2B = 3; TIMSK2 = 1", 32 * 256),
        ("TIMER2_COMPA_vect", "TCCR2A = 2; OCR2A = 249; TCCR2B = 4; TIMSK2 = 2", 64 * 250),
        ("TIMER1_OVF_vect", "TCCR1A = 2; TCCR1B = 0x18; ICR1 = 419; TCCR1B = 0x19; TIMSK1 = 1", 420),
        (
            "TIMER1_COMPB_vect",
            "OCR1B = 5; TCCR1A = 2; TCCR1B = 0x18; ICR1 = 419; TCCR1B = 0x19; TIMSK1 = 4",
            420,
        ),
        ("TIMER1_CAPT_vect", "TCCR1B = 0x18; ICR1 = 999; TCCR1B = 0x19; TIMSK1 = 32", 1000),
        ("TIMER3_COMPC_vect", "OCR3A = 1234; OCR3C = 7; TCCR3B = 9; TIMSK3 = 8", 1235),
        ("TIMER4_OVF_vect", "TCCR4A = 2; TCCR4B = 0x10; ICR4 = 800; TCCR4B = 0x11; TIMSK4 = 1", 1600),
        ("TIMER4_OVF_vect", "OCR4A = 300; TCCR4A = 1; TCCR4B = 0x11; TIMSK4 = 1", 600),
    ],
)
def test_interrupts_come_with_the_mode_s_period(avr: Compile, vector: str, setup: str, period: int) -> None:
    tile = run(avr(MEASURE.replace("VECTOR", vector).replace("SETUP", setup)))
    times = words(tile.read_memory(0x1000, 8))
    # The program's loop of one two-cycle jump lets the entry vary by a cycle.
    assert [(b - a) % 65536 for a, b in pairwise(times)] == pytest.approx([period] * 3, abs=1)


def test_a_free_running_timer_counts_cycles(avr: Compile) -> None:
    source = """
    int main(void) {
        TCCR5B = 1;
        uint16_t before = TCNT5;
        __builtin_avr_delay_cycles(1000);
        result16[0] = TCNT5 - before;
        TCCR5B = 2;
        TCNT5 = 0;
        __builtin_avr_delay_cycles(8000);
        result16[1] = TCNT5;
        for (;;) { }
    }"""
    exact, eighth = words(run(avr(source)).read_memory(0x1000, 4))
    assert exact in range(1002, 1008)  # the two reads take their own cycles
    assert eighth in (1000, 1001)


def test_a_buffered_compare_value_waits_for_the_end_of_the_period(avr: Compile) -> None:
    source = """
    int main(void) {
        OCR1B = 5000; TCCR1A = 2; TCCR1B = 0x18; ICR1 = 9999; TCCR1B = 0x19;
        while (!(TIFR1 & 1)) { }            /* the compare value is in force from here on */
        TIFR1 = 0xFF;
        OCR1B = 100;                        /* too late for this period */
        while (!(TIFR1 & 4)) { }
        result16[0] = TCNT1;
        TIFR1 = 0xFF;
        while (!(TIFR1 & 4)) { }
        result16[1] = TCNT1;
        for (;;) { }
    }"""
    first, second = words(run(avr(source)).read_memory(0x1000, 4))
    assert first in range(5000, 5012)
    assert second in range(100, 112)


def test_duty_is_read_off_the_pins(avr: Compile) -> None:
    source = """
    int main(void) {
        DDRB = 0x30; DDRE = 0x28;
        TCCR2A = 0x81; TCCR2B = 4; OCR2A = 51;                  /* phase correct, 20 % */
        TCCR1A = 0x82; TCCR1B = 0x18; ICR1 = 399; OCR1A = 99; TCCR1B = 0x19;   /* fast, 100 of 400 */
        TCCR3A = 0x0D; OCR3C = 63; TCCR3B = 0x09;               /* fast, 8 bits, inverted, 64 of 256 */
        PORTE = 0x08;                                           /* no timer at all */
        for (;;) { }
    }"""
    tile = run(avr(source))
    assert tile.duty("B", 4) == pytest.approx(0.2)
    assert tile.duty("B", 5) == pytest.approx(0.25)
    assert tile.duty("E", 5) == pytest.approx(0.75)
    assert tile.duty("E", 3) == 1.0
    assert tile.duty("E", 4) == 0.0
    assert tile.rgb == (64, 51, 191)


def test_a_compare_output_really_toggles_its_pin(avr: Compile) -> None:
    source = """
    int main(void) {
        DDRB = 0x20; OCR1A = 1999; TCCR1A = 0x40; TCCR1B = 9;
        uint8_t before = PINB & 0x20;
        for (uint8_t n = 0; n < 100; ) {
            uint8_t now = PINB & 0x20;
            if (now != before) { before = now; n++; if (n == 1) TCCR5B = 1; }
        }
        result16[0] = TCNT5;
        for (;;) { }
    }"""
    (passed,) = words(run(avr(source)).read_memory(0x1000, 2))
    assert passed == pytest.approx(99 * 2000 % 65536, abs=20)


@pytest.mark.parametrize(
    ("timer", "setup", "period"),
    [
        (1, "TCCR1A = 1; TCCR1B = 0x0A; OCR1A = 99", 8 * 256),  # mode 5
        (1, "TCCR1A = 3; TCCR1B = 0x0A; OCR1A = 99", 8 * 1024),  # mode 7
        (1, "TCCR1A = 1; TCCR1B = 0x11; OCR1A = 999", 2 * 999),  # mode 9
        (1, "TCCR1A = 3; TCCR1B = 0x11; OCR1A = 999", 2 * 999),  # mode 11
        (1, "TCCR1A = 3; TCCR1B = 0x19; OCR1A = 999", 1000),  # mode 15
        (1, "TCCR1A = 3; TCCR1B = 0x19; OCR1A = 999; _delay_us(500); OCR1A = 60000", 60001),
        (1, "TCCR1A = 3; TCCR1B = 0x19; OCR1A = 60000; _delay_ms(5); OCR1A = 999", 1000),
        (2, "TCCR2A = 1; TCCR2B = 0x0A; OCR2A = 99", 8 * 2 * 99),  # mode 5
        (2, "TCCR2A = 3; TCCR2B = 0x0A; OCR2A = 99", 8 * 100),  # mode 7
    ],
)
def test_a_top_that_waits_in_its_buffer_comes_into_force_unseen(
    avr: Compile, timer: int, setup: str, period: int
) -> None:
    source = f"""
    int main(void) {{
        {setup};
        _delay_ms(10);                                      /* nobody looks at the timer meanwhile */
        TCCR5B = 1;
        for (uint8_t n = 0; n < 3; n++) {{
            TIFR{timer} = 1;
            while (!(TIFR{timer} & 1)) {{ }}
            result16[n] = TCNT5;
        }}
        for (;;) {{ }}
    }}"""
    times = words(run(avr(source)).read_memory(0x1000, 6))
    assert [(b - a) % 65536 for a, b in pairwise(times)] == pytest.approx([period] * 2, abs=8)


@pytest.mark.parametrize("mode", [(0x40, 0x09), (0x41, 0x11), (0x43, 0x11), (0x43, 0x19)])
@pytest.mark.parametrize("top", [5, 6, 37])
def test_an_output_is_the_same_however_often_it_is_looked_at(
    avr: Compile, mode: tuple[int, int], top: int
) -> None:
    setup = f"DDRB = 0x20; TCCR1A = {mode[0]}; OCR1A = {top}; TCCR1B = {mode[1]};"
    elf = avr(f"int main(void) {{ {setup} for (;;) {{ }} }}")
    watched, levels = Array(elf), []
    for _ in range(24):
        watched.run(16e-6)
        levels.append(watched[0].pin("B", 5))
    unwatched = []
    for moment in range(24):
        with Array(elf) as array:
            array.run(16e-6 * (moment + 1))
            unwatched.append(array[0].pin("B", 5))
    assert unwatched == levels
    assert len(set(levels)) == 2


def test_a_compare_value_that_comes_within_reach_interrupts(avr: Compile) -> None:
    source = """
    ISR(TIMER1_COMPB_vect) { result[0]++; }
    int main(void) {
        result[0] = 0;
        OCR1B = 5000; TCCR1A = 2; TCCR1B = 0x18; ICR1 = 419; TCCR1B = 0x19;     /* 5000: never */
        TIMSK1 = 4; sei();
        _delay_ms(1); result[1] = result[0];
        OCR1B = 7;
        for (;;) { }
    }"""
    memory = run(avr(source), 0.002).read_memory(0x1000, 2)
    assert memory[1] == 0
    assert memory[0] in range(30, 42)  # of 420 cycles each, in a little less than a millisecond


def test_setting_up_the_adc_loses_no_overflow(avr: Compile) -> None:
    """The ADC asks timers 0 and 1 which of their flags may start it, perhaps in the cycle of an overflow."""
    source = """
    ISR(TIMER1_OVF_vect) { result16[0]++; }
    int main(void) {
        result16[0] = 0;
        ICR1 = 419; TCCR1A = 1 << WGM11; TCCR1B = 1 << WGM13 | 1 << WGM12 | 1 << CS10; TIMSK1 = 1 << TOIE1;
        sei();
        for (;;) { ADCSRA = 1 << ADEN | 1 << ADSC; }
    }"""
    overflows = words(run(avr(source), 0.1).read_memory(0x1000, 2))[0]
    assert overflows == pytest.approx(1.6e6 / 420, abs=2)
