"""Three tiles of which everything that holds state is in use."""

from tilenca.base.sides import EAST, WEST
from tilenca.emulator import Array, LinkFault

# What is in use: timers, USARTs, EEPROM, ADC, SPI, TWI, the watchdog, sleep, the heap.
BUSY = """
#include <stdlib.h>
static volatile uint16_t ticks, bytes, conversions;
static volatile uint32_t sum;
ISR(TIMER1_COMPA_vect) { ticks++; UDR1 = ticks; }
ISR(TIMER3_CAPT_vect) { sum += ICR3; }
ISR(USART3_RX_vect) { bytes++; sum = sum * 31 + UDR3; }
ISR(ADC_vect) { conversions++; sum += ADC; }
ISR(WDT_vect) { sum ^= 0x55; }
ISR(PCINT2_vect) { sum += 3; }
int main(void) {
    uint8_t *block = malloc(100);
    UBRR1 = UBRR3 = 16; UCSR1A = UCSR3A = 2; UCSR1B = 8; UCSR3B = 0x90;
    UBRR0 = 16; UCSR0A = 2; UCSR0B = 0x18;
    OCR1A = 7999; TCCR1B = 9; TIMSK1 = 2;
    DDRB = 0x77; TCCR2A = 0x83; OCR2A = 77; TCCR2B = 2;
    TCCR3B = 1; TIMSK3 = 0x20; TCCR4A = 0x81; OCR4A = 100; TCCR4B = 0x11; DDRH = 0x08;
    ADMUX = 0x40; ADCSRA = 0xEF;
    SPCR = 0x53; SPDR = 0x3C; TWBR = 72; TWCR = 0xA4;
    PCMSK2 = 0x80; PCICR = 4;
    cli(); WDTCSR = 0x18; WDTCSR = 0x40; sei();
    set_sleep_mode(SLEEP_MODE_IDLE);
    for (uint16_t n = 0;; n++) {
        if (n % 4 == 0) eeprom_update_byte((uint8_t *)(n & 0xFF), n);
        if (SPSR & 0x80) SPDR = n;
        if (TWCR & 0x80) TWCR = 0x94;
        block[n % 100] += n;
        if (UCSR0A & 0x20) UDR0 = sum;
        if (n % 8 == 0) sleep_mode();
    }
}
"""


def build(elf: object, threads: int = 1, translated: bool = False) -> Array:
    array = Array(
        str(elf), 3, [(0, EAST, 1, WEST), (1, EAST, 2, WEST)], [400, -400, 0], [0, 0.001, 0.002],
        threads=threads, translated=translated,
    )  # fmt: skip
    array.set_fault(0, EAST, LinkFault(loss=0.1, flip=0.02), seed=9)
    array[1].set_adc_noise(2.0, seed=4)
    array[2].set_drift(200.0)
    array[1].set_skew(-500.0)
    for tile in array:
        tile.set_analog(0, 300 + tile.index)
    return array
