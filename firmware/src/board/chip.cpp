#include "board/chip.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

#include "board/scratch.h"

namespace tilenca {
namespace board {

namespace {

uint32_t now = 0; // the last result of now_ms()

} // namespace

// What the interrupts in avr/clock.S work on.
extern "C" {
volatile uint8_t tilenca_ticks = 0; // milliseconds modulo 256, since a longer count would take longer
volatile uint8_t tilenca_leds = 0;  // the link LEDs to light: bits as in show_leds()
}

void clock_begin() {
    // Fast PWM with ICR4 as top (mode 14), one count per cycle: its outputs dim segments.
    TCCR4B = 0;
    TCCR4A = 1 << WGM41;
    TCCR4B = 1 << WGM43 | 1 << WGM42;
    ICR4 = kClockTop - 1;
    TCNT4 = 0;
    TIFR4 = 1 << TOV4;
    scratch_begin();
    TIMSK4 = 1 << TOIE4;
    TCCR4B |= 1 << CS40;
}

uint32_t now_ms() {
    now += static_cast<uint8_t>(tilenca_ticks - static_cast<uint8_t>(now));
    return now;
}

uint16_t stamp() {
    const uint8_t interrupts = SREG;
    cli();
    const uint16_t count = TCNT5; // the south link's interrupt uses the same latch for its high byte
    SREG = interrupts;
    return count;
}

void sleep() {
    set_sleep_mode(SLEEP_MODE_IDLE);
    sleep_enable();
    cli();
    while (tilenca_ticks == static_cast<uint8_t>(now)) {
        sei(); // takes effect after the next instruction, so a tick in between ends the sleep at once
        sleep_cpu();
        cli();
    }
    sei();
    sleep_disable();
}

} // namespace board
} // namespace tilenca
