"""Where libsimavr 1.6 is wrong: what the data sheet says, what we do, and what it does.

docs/EMULATOR.md lists the same; a test keeps the two together.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import pytest

from support.avr import ROOT, Compile, compile_differential, run_tool

SPEAK = """
#include <avr/boot.h>
#include <stdlib.h>
static void put(uint8_t c) { while (!(UCSR0A & 0x20)) { } UDR0 = c; }
static void say(uint32_t n) { char t[12]; ultoa(n, t, 10); for (char *c = t; *c; c++) put(*c); put(' '); }
"""


@dataclass(frozen=True)
class Mistake:
    """One difference.

    Attributes:
        what: in words, as in the document.
        section: of the data sheet (Atmel document 2549).
        handlers: interrupt handlers and variables.
        program: what main() does; it says numbers.
        right: what it says by the data sheet, and here.
        theirs: what it says on libsimavr.
    """

    what: str
    section: str
    handlers: str
    program: str
    right: str
    theirs: str


MISTAKES = [
    Mistake(
        "an interrupt is entered in no time; 5 cycles are right", "7.8.1",
        "volatile uint16_t at; ISR(TIMER1_COMPA_vect) { at = TCNT1; }",
        "OCR1A = 999; TCCR1B = 1; TIMSK1 = 2; sei(); while (!at) { } say(at);", "1022", "1016",
    ),
    Mistake(
        "waking from idle sleep takes no cycles; 5 more are right", "7.8.1",
        "volatile uint16_t at; ISR(TIMER1_COMPA_vect) { at = TCNT1; }",
        "OCR1A = 999; TCCR1B = 1; TIMSK1 = 2; sei(); sleep_mode(); say(at);", "1026", "1016",
    ),
    Mistake(
        "no pin-change interrupt on port K (PCINT16 to 23)", "15.2",
        "volatile uint8_t n; ISR(PCINT2_vect) { n++; }",
        "DDRK = 0x80; PCMSK2 = 0x80; PCICR = 4; sei();"
        " for (uint8_t i = 0; i < 6; i++) { PINK = 0x80; _delay_us(10); } say(n);", "6", "0",
    ),
    Mistake(
        "no pin-change interrupt on port J (PCINT9 to 15)", "15.2",
        "volatile uint8_t n; ISR(PCINT1_vect) { n++; }",
        "DDRJ = 1; PCMSK1 = 2; PCICR = 2; sei();"
        " for (uint8_t i = 0; i < 6; i++) { PINJ = 1; _delay_us(10); } say(n);", "6", "0",
    ),
    Mistake(
        "an 8-bit timer in phase correct PWM never reaches bottom: no TOV", "16.7.4", "",
        "TCCR2A = 1; TCCR2B = 1; _delay_us(200); say(TIFR2 & 1);", "1", "0",
    ),
    Mistake(
        "a 16-bit timer in phase correct PWM never reaches bottom: no TOV", "17.9.4", "",
        "TCCR1A = 1; TCCR1B = 1; _delay_us(200); say(TIFR1 & 1);", "1", "0",
    ),
    Mistake(
        "the same in phase and frequency correct PWM", "17.9.5", "",
        "TCCR1B = 0x10; ICR1 = 400; TCCR1B = 0x11; _delay_us(200); say(TIFR1 & 1);", "1", "0",
    ),
    Mistake(
        "in CTC mode TOV is set at the compare value; at the end of the counter's range is right",
        "17.9.2", "",
        "OCR1A = 100; TCCR1B = 9; _delay_us(20); say(TIFR1 & 1);", "0", "1",
    ),
    Mistake(
        "a compare cannot be forced (FOC)", "17.7.1", "",
        "DDRB = 0x20; OCR1A = 60000; TCCR1A = 0x40; TCCR1C = 0x80; _delay_us(1); say(PINB & 0x20);",
        "32", "0",
    ),
    Mistake(
        "a byte takes 10 % longer on a USART than its bits", "22.3.1", "",
        "UBRR1 = 103; UCSR1B = 8; TCCR5B = 2; UDR1 = 1; UDR1 = 2; while (!(UCSR1A & 0x20)) { }"
        " TCNT5 = 0; UDR1 = 3; while (!(UCSR1A & 0x20)) { } say(TCNT5);", "2080", "2289",
    ),
    Mistake(
        "double speed (U2X) halves nothing", "22.3.2", "",
        "UBRR1 = 207; UCSR1A = 2; UCSR1B = 8; TCCR5B = 2; UDR1 = 1; UDR1 = 2; while (!(UCSR1A & 0x20)) { }"
        " TCNT5 = 0; UDR1 = 3; while (!(UCSR1A & 0x20)) { } say(TCNT5);", "2079", "4577",
    ),
    Mistake(
        "a pin is read back at once; one cycle late is right", "13.2.4", "",
        'DDRB = 0xFF; uint8_t a; asm volatile("ldi r24, 0x5A\\n out %1, r24\\n in %0, %2\\n"'
        ' : "=r"(a) : "I"(_SFR_IO_ADDR(PORTB)), "I"(_SFR_IO_ADDR(PINB)) : "r24"); say(a);', "0", "90",
    ),
    Mistake(
        "an EEPROM write takes no time; 3.4 ms are right", "8.3.1", "",
        "TCCR5B = 3; TCNT5 = 0; eeprom_write_byte(0, 3); while (EECR & 2) { } say(TCNT5 > 800);", "1", "0",
    ),
    Mistake(
        "signature and fuses cannot be read by a program", "29.7", "",
        "say(boot_signature_byte_get(2)); say(boot_lock_fuse_bits_get(GET_LOW_FUSE_BITS));", "152 255",
        "114 12",
    ),
    Mistake(
        "power reduction stops nothing", "11.8", "",
        "TCCR1B = 1; PRR0 = 8; uint16_t a = TCNT1; _delay_us(50); say(TCNT1 - a > 100);", "0", "1",
    ),
    Mistake(
        "timers run on in power-down sleep", "11.4", "ISR(WDT_vect) { }",
        "TCCR1B = 5; WDTCSR = 0x18; WDTCSR = 0x40; set_sleep_mode(SLEEP_MODE_PWR_DOWN); sei();"
        " uint16_t a = TCNT1; sleep_mode(); say(TCNT1 - a > 2);", "0", "1",
    ),
    Mistake(
        "an SPI transfer takes half as long again", "21.2", "",
        "DDRB = 7; SPCR = 0x53; TCCR5B = 1; TCNT5 = 0; SPDR = 1; while (!(SPSR & 0x80)) { }"
        " say(TCNT5 > 1200);",
        "0", "1",
    ),
    Mistake("TWDR is 0 after a reset; 0xFF is right", "24.9.4", "", "say(TWDR);", "255", "0"),
]  # fmt: skip


@pytest.fixture(scope="module")
def differential(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compile_differential(tmp_path_factory.mktemp("differential"))


@pytest.mark.parametrize("mistake", MISTAKES, ids=[mistake.what for mistake in MISTAKES])
def test_we_do_what_the_data_sheet_says_and_libsimavr_does_not(
    differential: Path, avr: Compile, mistake: Mistake
) -> None:
    main = f"int main(void) {{ UBRR0 = 1; UCSR0A = 2; UCSR0B = 8; {mistake.program} for (;;) {{ }} }}"
    elf = avr(SPEAK + mistake.handlers + main)
    told = run_tool(differential, "both", elf, "3")
    ours, theirs = re.fullmatch(r"ours: (.*) libsimavr: (.*)\n", told).groups()  # type: ignore[union-attr]
    assert (ours.strip(), theirs.strip()) == (mistake.right, mistake.theirs)


def test_the_document_lists_the_same() -> None:
    document = (ROOT / "docs" / "EMULATOR.md").read_text()
    rows = re.findall(r"^\| (.*) \| ([0-9.]+) \|$", document, re.MULTILINE)
    assert rows == [(mistake.what, mistake.section) for mistake in MISTAKES]
