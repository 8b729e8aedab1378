"""Capture, external clocks, compare outputs, ADC, comparator, SPI and TWI against the data sheet."""

from itertools import pairwise

import pytest

from support.avr import Compile, words
from support.avr import IdealArray as Array
from tilenca.emulator import EmulatedTile


def run(elf: object, seconds: float = 0.01) -> EmulatedTile:
    array = Array(str(elf))
    array.run(seconds)
    return array[0]


# --- timers ---

ICP = {1: ("D", 4), 3: ("E", 7), 4: ("L", 0), 5: ("L", 1)}


@pytest.mark.parametrize("timer", [1, 3, 4, 5])
@pytest.mark.parametrize("rising", [True, False])
def test_an_edge_is_captured_with_its_moment(avr: Compile, timer: int, rising: bool) -> None:
    source = f"""
    ISR(TIMER{timer}_CAPT_vect) {{ result16[result[8]++] = ICR{timer}; }}
    int main(void) {{
        result[8] = 0; TIMSK{timer} = 0x20; TCCR{timer}B = {0x42 if rising else 0x02}; sei();
        for (;;) {{ }}
    }}"""
    array = Array(avr(source))
    for cycle, level in ((20_000, False), (36_000, True), (52_000, False), (84_000, True)):
        array[0].push_edge(*ICP[timer], cycle, level)
    array.run(0.01)
    memory = array[0].read_memory(0x1000, 9)
    first, second = words(memory[:4])
    assert memory[8] == 2
    assert second - first == (48_000 if rising else 32_000) / 8


@pytest.mark.parametrize(("width", "captured"), [(3, 0), (5, 1)])
def test_the_noise_canceller_wants_four_cycles(avr: Compile, width: int, captured: int) -> None:
    source = "int main(void) { TCCR1B = 0x81; for (;;) result[0] = TIFR1 >> 5 & 1; }"
    array = Array(avr(source))
    array[0].push_edge("D", 4, 30_000, False)
    array[0].push_edge("D", 4, 30_000 + width, True)
    array.run(0.01)
    assert array[0].read_memory(0x1000, 1)[0] == captured


T_PINS = [(0, "D", 7), (1, "D", 6), (3, "E", 6), (4, "H", 7), (5, "L", 2)]


@pytest.mark.parametrize(("timer", "port", "bit"), T_PINS)
@pytest.mark.parametrize("rising", [True, False])
def test_a_timer_counts_edges_of_its_t_pin(
    avr: Compile, timer: int, port: str, bit: int, rising: bool
) -> None:
    source = f"int main(void) {{ TCCR{timer}B = {7 if rising else 6}; for (;;) result[0] = TCNT{timer}; }}"
    array = Array(avr(source))
    for number in range(9):  # five falling edges, four rising ones
        array[0].push_edge(port, bit, 20_000 + 1000 * number, number % 2 == 1)
    array.run(0.01)
    assert array[0].read_memory(0x1000, 1)[0] == (4 if rising else 5)


@pytest.mark.parametrize(
    ("setup", "port", "bit", "high", "period"),
    [
        ("DDRB = 0x80; TCCR0A = 0x83; OCR0A = 99; TCCR0B = 2", "B", 7, 8 * 100, 8 * 256),  # fast PWM
        ("DDRH = 0x08; TCCR4A = 0x81; OCR4A = 51; TCCR4B = 1", "H", 3, 102, 510),  # phase correct
        ("DDRL = 0x08; TCCR5A = 0x40; OCR5A = 99; TCCR5B = 9", "L", 3, 100, 200),  # CTC, toggle
        (
            "DDRE = 0x10; ICR3 = 0; TCCR3A = 0x30; TCCR3B = 0x10; ICR3 = 200; OCR3B = 50; TCCR3B = 0x11",
            "E",
            4,
            300,
            400,
        ),  # phase and frequency correct, inverted
    ],
)
def test_a_compare_output_is_a_waveform_for_whoever_looks(
    avr: Compile, setup: str, port: str, bit: int, high: int, period: int
) -> None:
    array = Array(avr(f"int main(void) {{ {setup}; for (;;) {{ }} }}"))
    probe = array[0].probe(port, bit)
    array.run(0.005)
    edges = probe.read()[4:]
    rises = [edge.time_s * 16e6 for edge in edges if edge.level]
    falls = [edge.time_s * 16e6 for edge in edges if not edge.level]
    lengths = {round(b - a) for a, b in pairwise(rises)}
    assert lengths == {period}
    falls = falls[1:] if falls[0] < rises[0] else falls
    assert {round(fall - rise) for rise, fall in zip(rises, falls, strict=False)} == {high}


def share_of_time_high(array: Array, port: str, bit: int, seconds: float) -> float:
    probe = array[0].probe(port, bit)
    level, since_s, high_s = probe.level, array.time_s, 0.0
    end_s = since_s + seconds
    array.run(seconds)
    for edge in probe.read():
        high_s += (min(edge.time_s, end_s) - since_s) * level
        level, since_s = edge.level, edge.time_s
    return (high_s + max(0.0, end_s - since_s) * level) / seconds


@pytest.mark.parametrize(("port_bit", "share"), [(0, 0.5 * 0.25), (1, 1 - 0.5 * 0.75)])
def test_two_timers_modulate_one_pin(avr: Compile, port_bit: int, share: float) -> None:
    source = f"""
    int main(void) {{
        DDRB = 0x80; PORTB = {port_bit << 7};
        OCR0A = 63; TCCR0A = 0x83; TCCR0B = 1;                          /* a quarter of 256 cycles */
        TCCR1A = 0x0A; TCCR1B = 0x18; ICR1 = 4095; OCR1C = 2047; TCCR1B = 0x19;     /* half of 4096 */
        _delay_ms(5);
        TCCR1A = 0x02;                                                  /* timer 0 alone */
        for (;;) {{ }}
    }}"""
    array = Array(avr(source))
    array.run(0.001)
    assert share_of_time_high(array, "B", 7, 8 * 4096 / 16e6) == pytest.approx(share, abs=0.01)
    array.run(0.004)
    assert share_of_time_high(array, "B", 7, 256 * 16 / 16e6) == pytest.approx(0.25, abs=0.01)


def test_a_pin_change_interrupt_follows_a_compare_output(avr: Compile) -> None:
    source = """
    ISR(PCINT0_vect) { result16[0]++; }
    int main(void) {
        result16[0] = 0;
        DDRB = 0x10; OCR2A = 99; TCCR2A = 0x42; TCCR2B = 2;     /* 800 cycles */
        PCMSK0 = 0x10; PCICR = 1; sei();
        for (;;) { }
    }"""
    assert words(run(avr(source)).read_memory(0x1000, 2))[0] in range(199, 201)


def test_a_forced_compare_acts_on_the_pin_at_once(avr: Compile) -> None:
    source = """
    int main(void) {
        DDRB = 0x20; OCR1A = 60000; TCCR1A = 0x40; TCCR1B = 1;
        result[0] = PINB; TCCR1C = 0x80; _NOP(); result[1] = PINB; TCCR1C = 0x80; _NOP(); result[2] = PINB;
        result[3] = TIFR1 & 2;                                  /* and sets no flag */
        for (;;) { }
    }"""
    memory = run(avr("#include <avr/cpufunc.h>\n" + source), 0.001).read_memory(0x1000, 4)
    assert [byte >> 5 & 1 for byte in memory[:3]] == [0, 1, 0]
    assert memory[3] == 0


def test_prescalers_can_be_held_and_let_go_together(avr: Compile) -> None:
    source = """
    int main(void) {
        GTCCR = 0x83; TCCR1B = 1; TCCR3B = 1;
        _delay_ms(1);
        result16[0] = TCNT1; result16[1] = TCNT3;
        GTCCR = 0; _delay_us(10);
        uint16_t one = TCNT1, other = TCNT3;
        result16[2] = other - one; result16[3] = one;
        for (;;) { }
    }"""
    memory = words(run(avr(source)).read_memory(0x1000, 8))
    assert memory[:2] == [0, 0]
    assert memory[2] == 4  # two LDS of two cycles each lie between
    assert memory[3] in range(155, 175)


# --- analog ---


@pytest.mark.parametrize(
    ("source", "setup"),
    [
        (3, "OCR0A = 249; TCCR0A = 2; TCCR0B = 3"),  # timer 0, compare A: 16,000 cycles
        (4, "TCCR0B = 3"),  # timer 0, overflow: 16,384
        (5, "OCR1B = 9; OCR1A = 15999; TCCR1B = 9"),
        (6, "TCCR1A = 2; TCCR1B = 0x18; ICR1 = 15999; TCCR1B = 0x19"),
    ],
)
def test_a_timer_starts_conversions(avr: Compile, source: int, setup: str) -> None:
    program = f"""
    ISR(ADC_vect) {{ result16[0]++; TIFR0 = 0xFF; TIFR1 = 0xFF; }}
    int main(void) {{
        result16[0] = 0;
        ADCSRB = {source}; ADCSRA = 0xAC; sei();            /* divided by 16 */
        {setup};
        for (;;) {{ }}
    }}"""
    assert words(run(avr(program), 0.1).read_memory(0x1000, 2))[0] in range(96, 101)


def test_the_bandgap_converts_to_its_share_of_the_supply(avr: Compile) -> None:
    source = """
    int main(void) {
        for (uint8_t i = 0; i < 2; ++i) {
            ADMUX = 0x40 | (i ? 0x1E : 0x01); ADCSRA = 0xC7;
            while (ADCSRA & 0x40) { }
            result16[i] = ADC;
        }
        for (;;) { }
    }"""
    found = {}
    for volts in (5.0, 4.5, 3.3):
        array = Array(avr(source))
        array[0].set_analog(1, 777)  # a share of the supply already
        array[0].set_supply(volts)
        array.run(0.01)
        found[volts] = words(array[0].read_memory(0x1000, 4))
    assert found == {5.0: [777, 225], 4.5: [777, 250], 3.3: [777, 341]}


def test_an_edge_of_int0_starts_one_conversion_each(avr: Compile) -> None:
    source = """
    ISR(ADC_vect) { result[0]++; result16[1] = ADC; EIFR = 1; }
    int main(void) {
        result[0] = 0; EICRA = 3; ADMUX = 0x41; ADCSRB = 2; ADCSRA = 0xAC; sei();
        for (;;) { }
    }"""
    array = Array(avr(source))
    array[0].set_analog(1, 777)
    for number in range(7):
        array[0].push_edge("D", 0, 20_000 + 8000 * number, number % 2 == 1)
    array.run(0.01)
    assert array[0].read_memory(0x1000, 1) == b"\x03"
    assert words(array[0].read_memory(0x1002, 2)) == [777]


def test_free_running_conversions_follow_each_other(avr: Compile) -> None:
    source = """
    ISR(ADC_vect) { result16[0]++; }
    int main(void) { result16[0] = 0; ADCSRA = 0xEF; sei(); for (;;) { } }"""  # 13 clocks of 128 cycles
    assert words(run(avr(source), 0.1).read_memory(0x1000, 2))[0] == int((1.6e6 - 25 * 128) / (13 * 128)) + 1


def test_a_result_stays_between_the_reads_of_its_two_bytes(avr: Compile) -> None:
    source = """
    int main(void) {
        ADMUX = 0x40; ADCSRA = 0xE2;                            /* free running, 52 cycles each */
        _delay_us(20);
        uint8_t low = ADCL;
        result[8] = 1; while (result[8]) { }                    /* the voltage changes */
        _delay_us(20);
        result[0] = low; result[1] = ADCH;
        _delay_us(20);
        result16[1] = ADC;
        for (;;) { }
    }"""
    array = Array(avr(source))
    array[0].set_analog(0, 0x1FF)
    array.run(0.001)
    array[0].set_analog(0, 0x200)
    array.run(0.001)
    array[0].write_memory(0x1008, b"\0")
    array.run(0.001)
    assert words(array[0].read_memory(0x1000, 4)) == [0x1FF, 0x200]


@pytest.mark.parametrize(
    ("mux", "volts", "expected"),
    [
        (0x10, {0: 500, 1: 300}, 100),  # ADC0 - ADC1
        (0x10, {0: 300, 1: 500}, -100),
        (0x1D, {5: 200, 2: 40}, 80),  # ADC5 - ADC2
        (0x09, {1: 310, 0: 300}, 50),  # ADC1 - ADC0, times 10
        (0x0B, {1: 900, 0: 300}, 511),  # times 200, beyond its range
        (0x30, {8: 100, 9: 150}, -25),  # ADC8 - ADC9
        (0x2D, {11: 30, 10: 20}, 50),  # ADC11 - ADC10, times 10
        (0x1E, {}, 225),  # the bandgap
        (0x1F, {}, 0),
    ],
)
def test_differences_are_converted_with_their_sign(
    avr: Compile, mux: int, volts: dict[int, int], expected: int
) -> None:
    source = f"""
    int main(void) {{
        ADMUX = 0x40 | {mux & 31}; ADCSRB = {8 if mux & 32 else 0}; ADCSRA = 0xC4;
        while (ADCSRA & 0x40) {{ }}
        result16[0] = ADC;
        for (;;) {{ }}
    }}"""
    array = Array(avr(source))
    for channel, volt in volts.items():
        array[0].set_analog(channel, volt)
    array.run(0.01)
    assert words(array[0].read_memory(0x1000, 2)) == [expected & 0x3FF]


NOISE = """
static uint16_t many[200];
int main(void) {
    ADMUX = 0x40; ADCSRA = 0x84;
    for (uint8_t i = 0; i < 200; i++) { ADCSRA |= 0x40; while (ADCSRA & 0x40) { } many[i] = ADC; }
    for (;;) { asm volatile("" :: "r"(many)); }
}
"""


def test_noise_is_as_wide_as_asked_for_and_repeats_with_its_seed(avr: Compile) -> None:
    elf = avr(NOISE)

    def converted(deviation: float, seed: int) -> list[int]:
        array = Array(elf)
        array[0].set_analog(0, 500)
        array[0].set_adc_noise(deviation, seed)
        array.run(0.02)
        return words(array[0].variable("many"))

    assert set(converted(0.0, 1)) == {500}
    first = converted(3.0, 1)
    mean = sum(first) / len(first)
    deviation = (sum((value - mean) ** 2 for value in first) / len(first)) ** 0.5
    assert mean == pytest.approx(500, abs=1)
    assert deviation == pytest.approx(3, abs=0.6)
    assert converted(3.0, 1) == first
    assert converted(3.0, 2) != first


def test_the_comparator_compares_interrupts_and_captures(avr: Compile) -> None:
    source = """
    ISR(ANALOG_COMP_vect) { result[0]++; }
    ISR(TIMER1_CAPT_vect) { result[1]++; }
    int main(void) {
        result[0] = result[1] = 0;
        ACSR = 0x0F; TIMSK1 = 0x20; TCCR1B = 0x41; sei();      /* rising edges, for both */
        for (;;) result[2] = ACSR & 0x20;
    }"""
    array = Array(avr(source))
    for ain0, seen in ((0, (0, 0, 0)), (600, (1, 1, 0x20)), (300, (1, 1, 0)), (700, (2, 2, 0x20))):
        array[0].set_comparator(ain0, 500)
        array.run(0.001)
        assert tuple(array[0].read_memory(0x1000, 3)) == seen


def test_the_comparator_takes_its_other_input_from_the_multiplexer(avr: Compile) -> None:
    source = "int main(void) { ADCSRB = 0x40; ADMUX = 3; ACSR = 0x40; for (;;) result[0] = ACSR & 0x20; }"
    array = Array(avr(source))
    for volts, output in ((224, 0x20), (226, 0)):  # the bandgap is at 225
        array[0].set_analog(3, volts)
        array.run(0.001)
        assert array[0].read_memory(0x1000, 1)[0] == output


# --- SPI and TWI ---

SPI = """
int main(void) {
    DDRB = 0x07; SPCR = SETUP; SPSR = FAST; TCCR5B = 1;
    TCNT5 = 0; SPDR = 0xA5; result[4] = SPSR; while (!(SPSR & 0x80)) { }
    result16[0] = TCNT5; result[2] = SPDR; result[3] = SPSR;
    SPDR = 0x11; SPDR = 0x22; result[5] = SPSR & 0x40;
    while (!(SPSR & 0x80)) { }
    result[6] = SPDR;
    for (;;) { }
}
"""


@pytest.mark.parametrize(("setup", "fast", "bit"), [(0x50, 0, 4), (0x51, 1, 8), (0x7C, 0, 4), (0x53, 0, 128)])
def test_spi_transfers_take_their_time_and_bring_what_miso_says(
    avr: Compile, setup: int, fast: int, bit: int
) -> None:
    elf = avr(SPI, f"-DSETUP={setup}", f"-DFAST={fast}")
    for loopback, held, expected in ((True, True, 0xA5), (False, True, 0xFF), (False, False, 0x00)):
        array = Array(elf)
        array[0].set_spi_loopback(loopback)
        array[0].hold_pin("B", 3, held)
        array.run(0.001)
        memory = array[0].read_memory(0x1000, 7)
        assert words(memory[:2])[0] == pytest.approx(8 * bit, abs=14)
        assert memory[2:6] == bytes([expected, fast, fast, 0x40])
        assert memory[6] == (0x11 if loopback else expected)


def test_spi_shows_clock_and_data_on_its_pins(avr: Compile) -> None:
    array = Array(avr(SPI, "-DSETUP=0x51", "-DFAST=0"))  # mode 0, highest bit first, 16 cycles a bit
    clock, data = array[0].probe("B", 1), array[0].probe("B", 2)
    array.run(0.001)
    rises = [edge.time_s for edge in clock.read() if edge.level]
    changes = data.read()
    levels = [[edge.level for edge in changes if edge.time_s <= rise][-1] for rise in rises]
    assert len(rises) == 16
    value = 0
    for level in levels[:8]:
        value = value << 1 | level
    assert value == 0xA5


def test_another_master_ends_this_one(avr: Compile) -> None:
    array = Array(avr("int main(void) { SPCR = 0x50; result[0] = SPCR; result[1] = SPSR; for (;;) { } }"))
    array[0].hold_pin("B", 0, False)
    array.run(0.001)
    assert array[0].read_memory(0x1000, 2) == bytes([0x40, 0x80])


def test_nobody_answers_on_the_two_wires(avr: Compile) -> None:
    source = """
    static void wait(void) { while (!(TWCR & 0x80)) { } result[++result[0]] = TWSR & 0xF8; }
    int main(void) {
        result[0] = 0;
        TWBR = 72; TCCR5B = 1; TCNT5 = 0;
        TWCR = 0xA4; wait();
        TWDR = 0x42; TCNT5 = 0; TWCR = 0x84; wait(); uint16_t took = TCNT5;
        TWDR = 0x99; TWCR = 0x84; wait();
        TWCR = 0xA4; wait();
        TWDR = 0x43; TWCR = 0x84; wait();
        TWCR = 0x84; wait(); result[12] = TWDR;
        TWCR = 0x94; while (TWCR & 0x10) { }
        result[13] = TWSR & 0xF8;
        result16[5] = took;
        for (;;) { }
    }"""
    memory = run(avr(source)).read_memory(0x1000, 14)
    assert memory[:7] == bytes([6, 0x08, 0x20, 0x30, 0x10, 0x48, 0x58])
    assert words(memory[10:12])[0] == pytest.approx(9 * 160, abs=32)  # and the way into and out of wait()
    assert memory[12:] == bytes([0xFF, 0xF8])


def test_multi_processor_mode_hears_addresses_only(avr: Compile) -> None:
    source = """
    int main(void) {
        UBRR0 = 16; UCSR0A = 0x03; UCSR0C = 6; UCSR0B = 0x1C;     /* nine bits: the ninth from us is high */
        uint8_t n = 0;
        for (;;) { if (UCSR0A & 0x80) { uint8_t c = UDR0; if (n < 8) result[n++] = c; } result[15] = n; }
    }"""
    array = Array(avr(source))
    array[0].write_serial(b"ab")  # eight bits and a high stop bit: what the chip takes for the ninth bit
    array.run(0.01)
    assert array[0].read_memory(0x100F, 1) == b"\x02"
