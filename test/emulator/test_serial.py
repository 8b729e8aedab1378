"""USARTs and the software side of the south link: timing, buffers, errors, waveforms."""

from itertools import pairwise

import pytest

from support.avr import Compile, words
from support.avr import IdealArray as Array
from tilenca.base.sides import EAST, NORTH, SOUTH, WEST

SERIAL = """
static inline void open0(uint16_t ubrr) { UCSR0A = 2; UBRR0 = ubrr; UCSR0C = 6; UCSR0B = 0x18; }
static inline void put0(uint8_t c) { while (!(UCSR0A & 0x20)) { } UDR0 = c; }
"""
U2X_115200 = 16  # 117,647 baud: 2.1 % fast, as on every Arduino Mega


def test_bytes_follow_each_other_without_a_gap(avr: Compile) -> None:
    elf = avr(
        SERIAL + "int main(void) { open0(16); for (uint8_t i = 0; i < 200; i++) put0(i); for (;;) { } }"
    )
    array = Array(elf)
    array.run(0.1)
    received, times = array[0].read_serial_timed()
    assert received == bytes(range(200))
    gaps = [(b - a) * 16e6 for a, b in pairwise(times)]
    assert gaps == pytest.approx([10 * 8 * (U2X_115200 + 1)] * 199, abs=2)


def test_the_transmit_flags_tell_of_a_double_buffer(avr: Compile) -> None:
    source = (
        SERIAL
        + """
    int main(void) {
        open0(103); UCSR0A = 0;                      /* 9600 baud: 16,640 cycles a byte */
        TCCR5B = 2;                                  /* counts eighths */
        UDR0 = 1; UDR0 = 2;
        TCNT5 = 0;
        result[0] = UCSR0A;                          /* buffer full, nothing sent */
        while (!(UCSR0A & 0x20)) { }
        result16[1] = TCNT5;
        while (!(UCSR0A & 0x40)) { }
        result16[2] = TCNT5;
        UCSR0A = 0x40; result[6] = UCSR0A;
        for (;;) { }
    }"""
    )
    array = Array(avr(source))
    array.run(0.01)
    memory = array[0].read_memory(0x1000, 7)
    assert memory[0] == 0x00
    assert words(memory[2:6]) == pytest.approx([16640 / 8, 2 * 16640 / 8], abs=14)
    assert memory[6] == 0x20


def test_a_receiver_nobody_reads_keeps_two_bytes_and_the_last_and_says_so(avr: Compile) -> None:
    source = (
        SERIAL
        + """
    int main(void) {
        open0(16);
        _delay_ms(5);
        for (uint8_t i = 0; UCSR0A & 0x80; i++) { result[2 * i] = UCSR0A & 0x1C; result[2 * i + 1] = UDR0; }
        for (;;) { }
    }"""
    )
    array = Array(avr(source))
    array[0].write_serial(b"abcdef")
    array.run(0.01)
    assert array[0].read_memory(0x1000, 6) == bytes([0, ord("a"), 0, ord("b"), 0x08, ord("f")])


def test_a_break_is_a_zero_with_a_framing_error(avr: Compile) -> None:
    source = (
        SERIAL
        + """
    int main(void) {
        open0(103);
        while (!(UCSR0A & 0x80)) { }
        result[0] = UCSR0A & 0x1C; result[1] = UDR0;
        for (;;) { }
    }"""
    )
    array = Array(avr(source))
    array[0].push_edge("E", 0, 10_000, False)
    array[0].push_edge("E", 0, 60_000, True)
    array.run(0.01)
    assert array[0].read_memory(0x1000, 2) == bytes([0x10, 0])


def test_a_glitch_is_no_start_bit(avr: Compile) -> None:
    array = Array(
        avr(SERIAL + "int main(void) { open0(103); _delay_ms(8); result[0] = UCSR0A; for (;;) { } }")
    )
    array[0].push_edge("E", 0, 10_000, False)
    array[0].push_edge("E", 0, 10_300, True)  # of 832 cycles per bit
    array.run(0.01)
    assert array[0].read_memory(0x1000, 1) == b"\x22"


# Sends 0..249 from one tile's east; the other's west counts what is wrong, and what comes.
LINK = """
ISR(USART3_RX_vect) {
    uint8_t error = UCSR3A & 0x1C, c = UDR3;
    if (error || c != result[0]) result[1]++;
    result[0]++;
    result[2]++;
}
int main(void) {
    result[0] = result[1] = result[2] = 0;
    UBRR1 = 51; UCSR1A = 2; UCSR1B = 0x08;
    UBRR3 = 51; UCSR3A = 2; UCSR3B = 0x90;
    sei();
    if (eeprom_read_byte(0) == 1) {
        for (int i = 0; i < 250; i++) { while (!(UCSR1A & 0x20)) { } UDR1 = i; }
    }
    for (;;) { }
}
"""


# The data sheet's limits at double speed and eight data bits: 96.00 % and 103.90 % of the receiver's rate
# in the worst phase; by its figures 94.7 % and 105.3 % in the best.
@pytest.mark.parametrize(
    ("rate", "clean"), [(1.0, True), (1.038, True), (1.054, False), (0.961, True), (0.94, False)]
)
def test_hardware_links_tolerate_what_the_chip_tolerates(avr: Compile, rate: float, clean: bool) -> None:
    array = Array(avr(LINK), 2, [(0, EAST, 1, WEST)], ppm=[(rate - 1) * 1e6, 0])
    array[0].write_eeprom(0, b"\x01")
    array.run(0.1)
    _, wrong, count = array[1].read_memory(0x1000, 3)
    assert (count == 250 and wrong == 0) == clean


# One tile's SOUTH sends by hand from PK7 at 38,400 baud; the other's NORTH is a USART, and answers to PK6.
SOUTH_SENDS = """
#define BIT 416
static void bit_bang(uint8_t c) {
    uint16_t frame = (uint16_t)c << 1 | 0x200;
    for (uint8_t i = 0; i < 10; i++, frame >>= 1) {
        uint16_t from = TCNT4;
        if (frame & 1) PORTK |= 0x80; else PORTK &= 0x7F;
        while ((uint16_t)(TCNT4 - from) < BIT - 12) { }
    }
}
static volatile uint8_t edges;
static volatile uint16_t times[16];
ISR(PCINT2_vect) { uint16_t now = TCNT5; if (edges < 16) times[edges++] = now; }
int main(void) {
    TCCR4B = 1; TCCR5B = 1; PORTK = 0xC0; DDRK = 0x80;
    if (eeprom_read_byte(0) == 1) {
        _delay_ms(1);
        cli();
        for (int i = 0; i < 256; i++) bit_bang(i);
        PCICR = 4; PCMSK2 = 0x40; sei();
        _delay_ms(5);
        for (uint8_t i = 0; i < edges; i++) result16[i] = times[i];
        result[100] = edges;
        for (;;) { }
    }
    UBRR2 = 25; UCSR2B = 0x18;
    for (uint16_t i = 0; i < 256; i++) {
        while (!(UCSR2A & 0x80)) { }
        uint8_t error = UCSR2A & 0x1C;
        if (error || UDR2 != (uint8_t)i) result[0]++; else result[1]++;
    }
    _delay_ms(2);
    UDR2 = 0x55;
    for (;;) { }
}
"""


@pytest.mark.parametrize("ppm", [0, 3000, -3000])
def test_the_south_link_carries_real_waveforms_both_ways(avr: Compile, ppm: float) -> None:
    array = Array(avr(SOUTH_SENDS), 2, [(0, SOUTH, 1, NORTH)], ppm=[ppm, -ppm])
    array[0].write_eeprom(0, b"\x01")
    array.run(0.2)
    assert array[1].read_memory(0x1000, 2) == bytes([0, 0])  # none wrong, 256 right
    assert array[0].read_memory(0x1000 + 100, 1) == bytes([10])  # 0x55: an edge at every bit
    times = words(array[0].read_memory(0x1000, 20))
    gaps = [(b - a) % 65536 for a, b in pairwise(times)]
    assert gaps == pytest.approx([416 * (1 + 2 * ppm * 1e-6)] * 9, abs=4)  # in the receiver's own cycles


def test_an_ideal_input_nobody_drives_reads_high(avr: Compile) -> None:
    source = (
        "int main(void) { result[0] = PINK; result[1] = PINH; PORTK = 0xFF; result[2] = PINK; for (;;) { } }"
    )
    array = Array(avr(source))
    array.run(0.001)
    assert array[0].read_memory(0x1000, 3) == b"\xff\xff\xff"


def test_a_reset_cuts_a_frame_off(avr: Compile) -> None:
    array = Array(avr(SERIAL + "int main(void) { open0(103); UCSR0A = 0; put0(0); for (;;) { } }"))
    array.run(0.0004)
    array[0].reset()
    array.run(0.01)
    # The frame cut short and the one sent anew after it run into one.
    assert array[0].read_serial()[0] == 0


# UBRR as an Arduino's Serial.begin() chooses it, with what its text is then worth.
@pytest.mark.parametrize(
    ("ubrr", "double_speed", "baud"),
    [(1666, 1, 1200), (207, 1, 9600), (103, 0, 9600), (34, 1, 57600), (16, 1, 115200), (8, 1, 230400),
     (3, 1, 500000), (0, 1, 2000000), (9, 0, 100000)],
)  # fmt: skip
def test_the_computer_opens_the_port_at_the_program_s_speed(
    avr: Compile, ubrr: int, double_speed: int, baud: int
) -> None:
    source = (
        SERIAL
        + f"""
    int main(void) {{
        open0({ubrr}); UCSR0A = {double_speed} << 1;
        for (const char *at = "Hello, tile!"; *at; at++) put0(*at);
        while (!(UCSR0A & 0x80)) {{ }}
        put0(UDR0);
        for (;;) {{ }}
    }}"""
    )
    array = Array(avr(source))
    array.run(0.15)
    hello, times = array[0].read_serial_timed()
    assert hello == b"Hello, tile!"
    took = times[-1] - times[0]
    assert took == pytest.approx(11 * 10 / baud, rel=0.04)
    array[0].write_serial(b"?")
    array.run(0.03)
    assert array[0].read_serial() == b"?"


def test_a_program_may_change_its_speed(avr: Compile) -> None:
    source = (
        SERIAL
        + """
    int main(void) {
        open0(207); put0('a'); while (!(UCSR0A & 0x40)) { }
        open0(16); put0('b'); put0('c');
        for (;;) { }
    }"""
    )
    array = Array(avr(source))
    array.run(0.01)
    assert array[0].read_serial() == b"abc"
