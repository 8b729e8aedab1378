"""Interrupts, pins, sleep and the watchdog."""

import pytest

from support.avr import Compile, words
from support.avr import IdealArray as Array
from tilenca.emulator import EmulatedTile


def run(elf: object, seconds: float = 0.01) -> EmulatedTile:
    array = Array(str(elf))
    array.run(seconds)
    return array[0]


def test_entry_takes_five_cycles_and_the_instruction_after_sei_runs_first(avr: Compile) -> None:
    source = """
    ISR(TIMER1_OVF_vect, ISR_NAKED) {
        /* JMP in the vector: 3 cycles. Registers first: r16 must already be what follows SEI. */
        asm volatile("lds r18, %1\\n lds r19, %1+1\\n sts %0, r16\\n sts %0+2, r18\\n sts %0+3, r19\\n reti"
                     :: "i"(0x1000), "i"(0x84) : "memory");
    }
    int main(void) {
        TIMSK1 = 1;
        TCCR1B = 0;
        TIFR1 = 0xFF;
        TCNT1 = 0xFFFF; TCCR1B = 1;             /* overflows at once; the request waits for SEI */
        asm volatile("nop\\n nop\\n nop\\n ldi r16, 1\\n ldi r17, 0\\n sts 0x85, r17\\n sts 0x84, r17\\n"
                     "sei\\n ldi r16, 2\\n ldi r16, 3\\n" ::: "r16", "r17", "r18", "r19");
        for (;;) { }
    }"""
    memory = run(avr(source), 0.002).read_memory(0x1000, 4)  # before the timer overflows again
    assert memory[0] == 2
    # Counted from the cycle after the write of TCNT1L: SEI and LDI 2, entry 5, JMP 3, first cycle of LDS 1.
    assert words(memory[2:]) == [2 + 5 + 3 + 1]


def test_after_reti_one_instruction_runs_before_the_next_interrupt(avr: Compile) -> None:
    source = """
    volatile uint16_t main_steps;
    ISR(INT0_vect) { result[0]++; if (result[0] == 100) EIMSK = 0; }    /* level-triggered: asks for ever */
    int main(void) {
        result[0] = 0;
        EICRA = 0; EIMSK = 1; DDRD = 1;     /* PD0 driven low by ourselves */
        asm volatile("clr r24\\n sei\\n"
                     "1: .rept 8\\n inc r24\\n .endr\\n"
                     "lds r25, 0x1000\\n cpi r25, 100\\n brne 1b\\n sts 0x1001, r24\\n" ::: "r24", "r25");
        for (;;) { }
    }"""
    memory = run(avr(source)).read_memory(0x1000, 2)
    assert memory[0] == 100
    # 99 returns let one instruction pass each; eight in eleven of them are INC.
    assert memory[1] == pytest.approx(99 * 8 / 11, abs=8)


def test_lower_vectors_go_first(avr: Compile) -> None:
    source = """
    #define NOTE(n) static uint8_t at; (void)at; result[++result[0]] = n
    ISR(PCINT2_vect) { NOTE(1); }
    ISR(TIMER1_COMPB_vect) { NOTE(2); TIMSK1 = 0; }
    ISR(USART1_UDRE_vect) { NOTE(3); UCSR1B = 0; }
    ISR(TIMER5_OVF_vect) { NOTE(4); TIMSK5 = 0; }
    int main(void) {
        result[0] = 0;
        TCNT5 = 0xFFFF; TCCR5B = 1; TIMSK5 = 1;
        UCSR1B = 0x28;
        OCR1B = 3; TCCR1B = 1; TIMSK1 = 4;
        DDRK = 0x80; PCMSK2 = 0x80; PCICR = 4; PINK = 0x80;
        _delay_us(10);
        sei();
        for (;;) { }
    }"""
    assert run(avr(source)).read_memory(0x1000, 5) == bytes([4, 1, 2, 3, 4])


def test_pin_change_interrupts_come_on_every_bank(avr: Compile) -> None:
    source = """
    ISR(PCINT0_vect) { result[0]++; }
    ISR(PCINT1_vect) { result[1]++; }
    ISR(PCINT2_vect) { result[2]++; }
    int main(void) {
        result[0] = result[1] = result[2] = 0;
        PCICR = 7; PCMSK0 = 0x01; PCMSK1 = 0x02; PCMSK2 = 0x40;
        sei();
        for (;;) { }
    }"""
    array = Array(avr(source))
    array.run(0.001)
    tile = array[0]
    for port, bit, edges in (("B", 0, 3), ("J", 0, 4), ("K", 6, 5)):
        for number in range(edges):
            tile.hold_pin(port, bit, number % 2 == 1)
            array.run(0.0001)
        tile.hold_pin(port, bit + 1 if bit < 7 else 0, False)  # its neighbour is not watched
        array.run(0.0001)
    assert tile.read_memory(0x1000, 3) == bytes([3, 4, 5])


def test_an_edge_that_is_due_where_the_array_stops_is_not_forgotten(avr: Compile) -> None:
    source = """
    ISR(PCINT2_vect) { result[0]++; }
    int main(void) { result[0] = 0; PCICR = 4; PCMSK2 = 0x40; sei(); for (;;) { } }"""
    array = Array(avr(source))
    array.run(0.001)
    tile, step_s = array[0], 160e-6
    for edges in range(1, 41):
        tile.push_edge("K", 6, round((array.time_s + step_s) * 16e6) - edges % 4, edges % 2 == 0)
        array.run(step_s)
    array.run(step_s)
    assert tile.read_memory(0x1000, 1) == bytes([40])


@pytest.mark.parametrize(("sense", "falls", "rises"), [(1, 1, 1), (2, 1, 0), (3, 0, 1)])
def test_external_interrupts_know_their_edge(avr: Compile, sense: int, falls: int, rises: int) -> None:
    source = f"""
    ISR(INT3_vect) {{ result[0]++; }}
    ISR(INT6_vect) {{ result[1]++; }}
    int main(void) {{
        result[0] = result[1] = 0;
        EICRA = {sense} << 6; EICRB = {sense} << 4; EIMSK = 0x48; sei();
        for (;;) {{ }}
    }}"""
    array = Array(avr(source))
    array.run(0.001)
    for level, expected in ((False, falls), (True, falls + rises)):
        array[0].hold_pin("D", 3, level)
        array[0].hold_pin("E", 6, level)
        array.run(0.0001)
        assert array[0].read_memory(0x1000, 2) == bytes([expected] * 2)


def test_writing_a_one_to_pin_toggles_and_nobody_else_is_touched(avr: Compile) -> None:
    source = """
    int main(void) {
        DDRK = 0xF0; PORTK = 0x35;
        PINK = 0x80; result[0] = PORTK;
        DDRB = 0xFF; PORTB = 0xAA; PINB |= 0x01; result[1] = PORTB;   /* SBI: only bit 0 */
        result[2] = PINK & 0x0F;
        for (;;) { }
    }"""
    assert run(avr(source)).read_memory(0x1000, 3) == bytes([0xB5, 0xAB, 0x0F])


def test_sleep_costs_nothing_and_ends_with_an_interrupt(avr: Compile) -> None:
    source = """
    ISR(TIMER1_COMPA_vect) { result16[0]++; }
    int main(void) {
        result16[0] = 0;
        OCR1A = 15999; TCCR1B = 9; TIMSK1 = 2; set_sleep_mode(SLEEP_MODE_IDLE); sei();
        for (;;) sleep_mode();
    }"""
    tile = run(avr(source), 1.0)
    (wakes,) = words(tile.read_memory(0x1000, 2))
    total, asleep = tile.cycles
    assert wakes in (999, 1000)
    assert total == pytest.approx(16_000_000, abs=20)
    assert asleep / total > 0.99


def test_sleep_without_interrupts_is_for_ever(avr: Compile) -> None:
    tile = run(avr("int main(void) { SMCR = 1; cli(); sleep_cpu(); for (;;) result[0] = 77; }"), 0.5)
    assert tile.read_memory(0x1000, 1) != b"\x4d"
    assert tile.cycles[0] == pytest.approx(8_000_000, abs=20)


WATCHDOG = """
int main(void) {
    uint8_t cause = MCUSR;
    MCUSR = 0;
    wdt_disable();
    if (cause & 8) { UCSR0B = 0; result[0] = cause; result16[1] = eeprom_read_word(0); for (;;) { } }
    result[0] = 0;
    wdt_enable(WDTO_30MS);
    for (uint8_t i = 0; i < 5; i++) { _delay_ms(20); wdt_reset(); }
    eeprom_write_word(0, 1234);
    for (;;) { }
}
"""


def test_the_watchdog_resets_what_does_not_reset_it(avr: Compile) -> None:
    array = Array(avr(WATCHDOG))
    array.run(0.120)  # fed for 100 ms
    assert array[0].read_memory(0x1000, 1) == b"\x00"
    array.run(0.030)
    assert array[0].read_memory(0x1000, 1) == b"\x08"  # WDRF, and nothing else since power-on's was cleared
    assert words(array[0].read_memory(0x1002, 2)) == [1234]


def test_the_watchdog_interrupts_before_it_resets(avr: Compile) -> None:
    source = """
    ISR(WDT_vect) { result[1]++; }
    int main(void) {
        if (MCUSR & 8) { result[0] = 1; wdt_disable(); for (;;) { } }
        result[0] = result[1] = 0;
        cli(); WDTCSR = 0x18; WDTCSR = 0x48; sei();     /* 16 ms, interrupt and reset */
        for (;;) { }
    }"""
    array = Array(avr(source))
    array.run(0.020)
    assert array[0].read_memory(0x1000, 2) == bytes([0, 1])
    array.run(0.016)
    assert array[0].read_memory(0x1000, 2) == bytes([1, 1])


def test_the_watchdog_resets_when_its_interrupt_was_not_served(avr: Compile) -> None:
    source = """
    ISR(WDT_vect) { }
    int main(void) {
        uint8_t cause = MCUSR;
        MCUSR = 0;
        if (cause & 8) { result[0] = cause; wdt_disable(); for (;;) { } }
        result[0] = 0;
        cli(); WDTCSR = 0x18; WDTCSR = 0x48;            /* 16 ms, interrupt and reset, and nobody listens */
        for (;;) result[1] = WDTCSR;
    }"""
    array = Array(avr(source))
    array.run(0.020)
    assert array[0].read_memory(0x1000, 2) == bytes([0, 0xC8])
    array.run(0.016)
    assert array[0].read_memory(0x1000, 1) == b"\x08"


def test_a_pin_is_read_back_one_cycle_late(avr: Compile) -> None:
    source = """
    int main(void) {
        DDRB = 0xFF; PORTB = 0;
        asm volatile("ldi r24, 0x5A\\n out %0, r24\\n in r25, %1\\n in r26, %1\\n"
                     "sts 0x1000, r25\\n sts 0x1001, r26\\n"
                     "out %0, r1\\n nop\\n in r25, %1\\n sts 0x1002, r25\\n"
                     "sbi %0, 0\\n in r25, %1\\n sts 0x1003, r25\\n"
                     "cbi %0, 0\\n sbic %1, 0\\n sts 0x1004, r24\\n"
                     :: "I"(_SFR_IO_ADDR(PORTB)), "I"(_SFR_IO_ADDR(PINB)) : "r24", "r25", "r26", "memory");
        for (;;) { }
    }"""
    assert run(avr(source)).read_memory(0x1000, 5) == bytes([0x00, 0x5A, 0x00, 0x00, 0x5A])


@pytest.mark.parametrize("wire", [True, False])
def test_an_edge_leaves_its_mark_while_its_interrupt_is_off(avr: Compile, wire: bool) -> None:
    source = """
    ISR(INT3_vect) { result[1]++; }
    int main(void) {
        result[0] = result[1] = 0;
        EICRA = 0x80; EICRB = 0x30;                     /* INT3 falling, INT6 rising */
        sei();
        _delay_ms(2);
        result[0] = EIFR;
        EIMSK = 0x08;
        for (;;) { }
    }"""
    array = Array(avr(source))
    if wire:
        array[0].push_edge("D", 3, 16_000, False)
        array[0].push_edge("E", 6, 16_000, False)
    array.run(0.001)
    if not wire:
        array[0].hold_pin("D", 3, False)
        array[0].hold_pin("E", 6, False)
    array.run(0.002)
    assert array[0].read_memory(0x1000, 2) == bytes([0x08, 1])
