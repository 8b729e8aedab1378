"""The analog comparator: its multiplexer moves, and the rest of the chip hears of it."""

import pytest

from support.avr import Compile
from support.avr import IdealArray as Array

BANDGAP = 225  # of 1024: 1.1 V of 5 V


def started(elf: object, below: int = 100, above: int = 400) -> Array:
    """Channel 0 is below the bandgap, channels 1 and 9 above."""
    array = Array(str(elf))
    array[0].set_analog(0, below)
    array[0].set_analog(1, above)
    array[0].set_analog(9, above)
    return array


COUNT = """
ISR(ANALOG_COMP_vect) { result[0]++; }
int main(void) {
    result[0] = 0;
    ADMUX = 0; ADCSRB = 1 << ACME;
    ACSR = 1 << ACBG; ACSR = 1 << ACBG | 1 << ACI; ACSR = 1 << ACBG | 1 << ACIE;
    sei();
    MOVE;
    _delay_us(10);
    result[1] = ACSR & (1 << ACO);
    for (;;) { }
}
"""


@pytest.mark.parametrize(
    ("move", "interrupts"),
    [
        ("ADMUX = 1", 1),
        ("ADMUX = 1; _delay_us(5); ADMUX = 0; _delay_us(5); ADMUX = 1", 3),
        ("ADCSRB |= 1 << MUX5; ADMUX = 1", 1),
        ("ADCSRB = 0", 1),  # from channel 0 to AIN1, which is held above the bandgap
        ("ADCSRA = 1 << ADEN", 1),  # the converter takes its multiplexer back: AIN1
        ("PRR0 = 1 << PRADC; (void)ACSR", 1),  # without the converter there is no multiplexer
        ("ADMUX = 0x40", 0),
    ],
)
def test_an_input_that_moves_across_the_bandgap_interrupts(avr: Compile, move: str, interrupts: int) -> None:
    array = started(avr(COUNT.replace("MOVE", move)))
    array[0].set_comparator(0, 1024)
    array.run(0.001)
    assert array[0].read_memory(0x1000, 1)[0] == interrupts


@pytest.mark.parametrize(("edges", "rising", "captured"), [(0, False, True), (0, True, False)])
def test_a_moved_multiplexer_is_captured(avr: Compile, edges: int, rising: bool, captured: bool) -> None:
    source = f"""
    int main(void) {{
        ADMUX = {edges}; ADCSRB = 1 << ACME; ACSR = 1 << ACBG | 1 << ACIC;
        TCCR1B = {0x41 if rising else 0x01}; _delay_us(10); TIFR1 = 0xFF;
        uint16_t before = TCNT1;
        ADMUX = 1;                                      /* the output falls */
        uint16_t after = TCNT1;
        result[0] = TIFR1 >> ICF1 & 1;
        result[1] = ICR1 - before <= after - before;
        for (;;) {{ }}
    }}"""
    array = started(avr(source))
    array.run(0.001)
    memory = array[0].read_memory(0x1000, 2)
    assert memory[0] == captured
    assert not captured or memory[1]


def test_the_interrupt_flag_says_which_edges_count(avr: Compile) -> None:
    source = """
    int main(void) {
        ADCSRB = 1 << ACME;
        for (uint8_t mode = 0; mode < 4; mode++) {
            ADMUX = 0; ACSR = 1 << ACBG | mode;
            ACSR |= 1 << ACI; ADMUX = 1; result[2 * mode] = ACSR >> ACI & 1;        /* falls */
            ACSR |= 1 << ACI; ADMUX = 0; result[2 * mode + 1] = ACSR >> ACI & 1;    /* rises */
        }
        for (;;) { }
    }"""
    array = started(avr(source))
    array.run(0.001)
    assert array[0].read_memory(0x1000, 8) == bytes([1, 1, 0, 0, 1, 0, 0, 1])


def test_adjusting_a_result_to_the_left_acts_at_once(avr: Compile) -> None:
    source = """
    int main(void) {
        ADCSRA = 1 << ADEN | 1 << ADSC; ADMUX = 0;
        while (ADCSRA & 1 << ADSC) { }
        result16[0] = ADC;
        ADMUX = 1 << ADLAR; result16[1] = ADC;
        ADMUX = 0; result16[2] = ADC;
        for (;;) { }
    }"""
    array = started(avr(source), below=0x155)
    array.run(0.001)
    raw = array[0].read_memory(0x1000, 6)
    assert [int.from_bytes(raw[at : at + 2], "little") for at in (0, 2, 4)] == [0x155, 0x5540, 0x155]
