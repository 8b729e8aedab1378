#include "board/chip.h"

#include <avr/eeprom.h>
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

namespace tilenca {
namespace board {

namespace {

volatile uint8_t ticks = 0; // milliseconds modulo 256: all that the interrupt has time for
uint32_t now = 0;           // as last told

} // namespace

void clock_begin() {
    TIMSK0 = 0;
    TCCR4A = 0;
    TCCR4B = 1 << WGM42 | 1 << CS40; // from 0 to OCR4A, one count per cycle
    OCR4A = F_CPU / 1000 - 1;
    TCNT4 = 0;
    TIMSK4 = 1 << OCIE4A;
}

uint32_t now_ms() {
    now += static_cast<uint8_t>(ticks - static_cast<uint8_t>(now));
    return now;
}

ISR(TIMER4_COMPA_vect) {
    ++ticks;
}

void sleep() {
    set_sleep_mode(SLEEP_MODE_IDLE);
    sleep_enable();
    cli();
    while (ticks == static_cast<uint8_t>(now)) {
        sei(); // takes effect after the next instruction: a tick that comes in between ends the sleep at once
        sleep_cpu();
        cli();
    }
    sei();
    sleep_disable();
}

void read_eeprom(uint8_t* bytes, uint8_t size) {
    eeprom_read_block(bytes, nullptr, size);
}

uint8_t take_reset_cause() {
    const uint8_t cause = MCUSR;
    MCUSR = 0;
    return cause;
}

} // namespace board
} // namespace tilenca
