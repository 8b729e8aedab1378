"""The cycle in which a timer's registers change, and what it shares with the others.

Measured on a Uno by others: a count that is written is read back unchanged in the next cycle, and a clock
that is switched on in one cycle counts from the end of the next one.
"""

from itertools import pairwise

import pytest

from support.avr import Compile, words
from support.avr import IdealArray as Array


def result(elf: object, count: int, seconds: float = 0.01) -> bytes:
    array = Array(str(elf))
    array.run(seconds)
    return array[0].read_memory(0x1000, count)


def assembly(lines: str) -> str:
    """A program of these instructions, which leaves r20 to r23 in `result`; r16 to r18 are free."""
    text = "".join(f"{line.strip()}\\n" for line in lines.strip().splitlines())
    return f"""int main(void) {{
        asm volatile("{text} sts 0x1000, r20\\n sts 0x1001, r21\\n sts 0x1002, r22\\n sts 0x1003, r23\\n"
                     ::: "r16", "r17", "r18", "r20", "r21", "r22", "r23");
        for (;;) {{ }}
    }}"""


# OUT and IN take one cycle, STS and LDS two, and theirs is the second.
@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        # TCNT0 is written and read at once, one cycle later, and by the second cycle of LDS.
        ("ldi r16, 1\n out 0x25, r16\n ldi r17, 0\n out 0x26, r17\n in r20, 0x26", [0]),
        ("ldi r16, 1\n out 0x25, r16\n ldi r17, 0x30\n out 0x26, r17\n nop\n in r20, 0x26", [0x31]),
        ("ldi r16, 1\n out 0x25, r16\n ldi r17, 0\n out 0x26, r17\n nop\n lds r20, 0x46", [2]),
        # Timer 2 is switched on, and read at once or a cycle later.
        ("ldi r16, 1\n sts 0xB1, r16\n lds r20, 0xB2", [1]),
        ("ldi r16, 1\n sts 0xB1, r16\n nop\n lds r20, 0xB2", [2]),
        # It stops with the same delay.
        ("ldi r16, 1\n ldi r17, 0\n sts 0xB1, r16\n sts 0xB1, r17\n nop\n lds r20, 0xB2", [2]),
        # Phase correct, up to 3: a written 2 is read, then 3, 2, 1.
        (
            "ldi r16, 3\n out 0x27, r16\n ldi r16, 1\n out 0x24, r16\n ldi r16, 9\n out 0x25, r16\n"
            "ldi r16, 2\n out 0x26, r16\n in r20, 0x26\n in r21, 0x26\n in r22, 0x26\n in r23, 0x26",
            [2, 3, 2, 1],
        ),
        # A compare value of 5 is there in the cycle in which the count is 5, or one cycle too late.
        (
            "ldi r16, 4\n out 0x26, r16\n ldi r16, 1\n ldi r17, 5\n ldi r18, 0xFF\n out 0x15, r18\n"
            "out 0x25, r16\n out 0x27, r17\n in r20, 0x15\n in r21, 0x15",
            [0, 2],
        ),
        (
            "ldi r16, 4\n out 0x26, r16\n ldi r16, 1\n ldi r17, 5\n ldi r18, 0xFF\n out 0x15, r18\n"
            "out 0x25, r16\n nop\n out 0x27, r17\n in r20, 0x15\n in r21, 0x15",
            [0, 0],
        ),
    ],
)  # fmt: skip
def test_a_register_has_its_new_value_in_the_cycle_after_the_write(
    avr: Compile, lines: str, expected: list[int]
) -> None:
    assert list(result(avr(assembly(lines)), len(expected))) == expected


@pytest.mark.parametrize(("timer", "flags"), [(0, 0x07), (2, 0x07), (1, 0x0F), (3, 0x0F)])
def test_a_full_count_sets_the_flags_that_there_are(avr: Compile, timer: int, flags: int) -> None:
    source = f"int main(void) {{ TCCR{timer}B = 1; _delay_ms(6); result[0] = TIFR{timer}; for (;;) {{ }} }}"
    assert result(avr(source), 1)[0] == flags


@pytest.mark.parametrize(
    ("mode", "mask"),
    [
        (1, 0xFF),
        (5, 0xFF),
        (2, 0x1FF),
        (6, 0x1FF),
        (3, 0x3FF),
        (7, 0x3FF),
        (0, 0xFFFF),
        (4, 0xFFFF),
        (14, 0xFFFF),
    ],
)
@pytest.mark.parametrize("timer", [1, 5])
def test_a_compare_register_has_as_many_bits_as_its_mode_counts(
    avr: Compile, timer: int, mode: int, mask: int
) -> None:
    source = f"""
    int main(void) {{
        TCCR{timer}A = {mode & 3}; TCCR{timer}B = {mode >> 2 << 3};
        OCR{timer}A = 0xFFFF; OCR{timer}B = 0x5A5A; OCR{timer}C = 0xA5A5;
        result16[0] = OCR{timer}A; result16[1] = OCR{timer}B; result16[2] = OCR{timer}C;
        for (;;) {{ }}
    }}"""
    found = words(result(avr(source), 6))
    assert found == [0xFFFF & mask, 0x5A5A & mask, 0xA5A5 & mask]


def test_the_capture_register_takes_a_value_in_every_mode(avr: Compile) -> None:
    source = """
    int main(void) {
        ICR1 = 6500; result16[0] = ICR1;                    /* normal mode */
        TCCR1A = 1; ICR1 = 1234; result16[1] = ICR1;        /* mode 1 */
        TCCR1A = 3; TCCR1B = 0x18; ICR1 = 4321; result16[2] = ICR1;     /* mode 15: up to OCR1A */
        TCCR1A = 2; result16[3] = ICR1;                     /* mode 14 begins with what is there */
        for (;;) { }
    }"""
    assert words(result(avr(source), 8)) == [6500, 1234, 4321, 4321]


def test_a_top_that_is_written_before_its_mode_is_the_top(avr: Compile) -> None:
    """As most Arduino sketches for servos do: ICR1 first, then the mode."""
    setup = "DDRB = 0x20; ICR1 = 39999; OCR1A = 3000; TCCR1A = 0x82; TCCR1B = 0x1A;"
    array = Array(avr(f"int main(void) {{ {setup} for (;;) {{ }} }}"))
    probe = array[0].probe("B", 5)
    array.run(0.13)
    edges = probe.read()
    rises = [edge.time_s for edge in edges if edge.level]
    assert len(rises) in (6, 7)
    periods = [(b - a) * 16e6 for a, b in pairwise(rises[1:])]
    assert periods == pytest.approx([8 * 40000] * len(periods), abs=1)


def test_power_reduction_stops_a_timer_and_not_the_prescaler(avr: Compile) -> None:
    """Timers 0 and 1 count with the same ticks, before and after timer 1 was off for a while."""
    source = """
    #define STEP(timer) ({ uint8_t was = TCNT##timer; while ((uint8_t)TCNT##timer == was) { } TCNT5; })
    int main(void) {
        TCCR5B = 1; TCCR0B = 4; TCCR1B = 4;                 /* clock / 256 */
        for (uint8_t n = 0; n < 4; n++) {
            result16[2 * n] = STEP(0); result16[2 * n + 1] = STEP(1);
            PRR0 = 1 << PRTIM1; __builtin_avr_delay_cycles(1000 + 61); PRR0 = 0;
        }
        for (;;) { }
    }"""
    moments = words(result(avr(source), 16))
    for of_timer_0, of_timer_1 in zip(moments[::2], moments[1::2], strict=True):
        apart = (of_timer_1 - of_timer_0) % 256
        assert min(apart, 256 - apart) <= 20, moments  # the loops look every ten cycles or so


# The data sheet, section 18.1: the prescaler runs freely, whatever the clock select of a timer, so the first
# count comes 1 to N + 1 cycles after a timer is enabled. An emulator that begins to divide with the write
# that enables a timer counts first after N cycles.
@pytest.mark.parametrize(("select", "divisor"), [(3, 64), (4, 256), (5, 1024)])
def test_the_first_count_comes_with_the_prescaler_s_next_tick(
    avr: Compile, select: int, divisor: int
) -> None:
    source = f"""
    int main(void) {{
        for (uint8_t n = 0; n < 8; n++) {{
            TCCR0B = 0; TCNT0 = 0; TCCR5B = 0; TCNT5 = 0;
            GTCCR = 1; TCCR5B = 1;                          /* both start from zero, two cycles apart */
            for (uint8_t wait = 0; wait < n * 5; wait++) asm volatile("nop");
            TCCR0B = {select};
            while (!TCNT0) {{ }}
            result16[n] = TCNT5;
        }}
        for (;;) {{ }}
    }}"""
    for cycles in words(result(avr(source), 16)):
        assert cycles < 8 * divisor, cycles
        assert cycles % divisor < 16, cycles  # seen as soon as the loop looks


def test_prescaler_ticks_are_exact_to_the_cycle(avr: Compile) -> None:
    """Eight cycles after the prescaler was reset, to the cycle, the count changes."""
    found = []
    for nops in range(3, 9):
        setup = "ldi r16, 2\n out 0x25, r16\n ldi r17, 0\n ldi r18, 1\n out 0x26, r17\n out 0x23, r18\n"
        program = setup + "nop\n" * nops + "in r20, 0x26"
        found.append(result(avr(assembly(program)), 1)[0])
    assert found == [0, 0, 0, 0, 0, 1]
