#include "board/display.h"

#include <avr/io.h>

#include "board/chip.h"
#include "board/gpio.h"
#include "board/south_uart.h"

namespace tilenca {
namespace board {

extern "C" volatile uint8_t tilenca_leds; // chip.cpp
static_assert(kDebugLeds[0].port == 'K' && kDebugLeds[0].bit == 0 && kDebugLeds[1].bit == 1 &&
                  kDebugLeds[2].bit == 2 && kDebugLeds[3].bit == 3,
              "avr/clock.S");

void display_begin() {
    for (Pin pin : kSegments) {
        make_output(pin);
    }
    for (Pin pin : kDebugLeds) {
        make_output(pin);
    }
    make_output(kRed);
    make_output(kGreen);
    make_output(kBlue);
    // Phase-correct 8-bit PWM at 490 Hz, which unlike fast PWM is fully dark at 0.
    TCCR2A = 1 << WGM20;
    TCCR2B = 1 << CS22;
    TCCR3A = 1 << WGM30;
    TCCR3B = 1 << CS31 | 1 << CS30;
    show_segments(0, 0);
    show_colour(0, 0, 0);
}

namespace {

// The compare value for a duty of 1..255 on a fast PWM timer of `counts` counts.
uint16_t compare_of(uint8_t duty, uint16_t counts) {
    return static_cast<uint16_t>(static_cast<uint32_t>(duty) * counts / 255 - 1);
}

// The register and the bit that connect a segment's pin to a timer. Each has a compare unit of its own. The
// decimal point's pin is on timer 0, which is used otherwise (scratch.h).
struct Dimmer {
    volatile uint8_t* control;
    uint8_t bit;
};
constexpr uint8_t kDimmed = 7;

Dimmer dimmer_of(uint8_t segment) {
    switch (segment) {
    case 0:
        return {&TCCR4A, COM4B1};
    case 1:
        return {&TCCR4A, COM4A1};
    case 2:
        return {&TCCR3A, COM3A1};
    case 3:
        return {&TCCR1A, COM1C1};
    case 4:
        return {&TCCR1A, COM1B1};
    case 5:
        return {&TCCR2A, COM2B1};
    default:
        return {&TCCR4A, COM4C1};
    }
}

void set_duty_of_segments(uint8_t duty) {
    OCR4A = OCR4B = OCR4C = compare_of(duty, kClockTop);
    OCR1B = OCR1C = compare_of(duty, kSouthBitCycles);
    OCR3A = duty;
    OCR2B = duty;
}

} // namespace

void show_segments(uint8_t segments, uint8_t brightness) {
    if (brightness == 0) {
        segments = 0;
    } else {
        set_duty_of_segments(brightness);
    }
    for (uint8_t i = 0; i < kDimmed; ++i) {
        const Dimmer dimmer = dimmer_of(i);
        // At full brightness the pin is simply high: no timer, no flicker.
        if ((segments >> i & 1) && brightness != 0xFF) {
            *dimmer.control |= 1 << dimmer.bit;
        } else {
            *dimmer.control &= ~(1 << dimmer.bit);
        }
    }
    for (uint8_t i = 0; i < 8; ++i) {
        set(kSegments[i], segments >> i & 1);
    }
}

void show_colour(uint8_t red, uint8_t green, uint8_t blue) {
    // Red's timer runs at the south link's bit time, and at duty 0 still gives a short pulse per bit.
    if (red == 0) {
        TCCR1A &= ~(1 << COM1A1);
    } else {
        OCR1A = compare_of(red, kSouthBitCycles);
        TCCR1A |= 1 << COM1A1;
    }
    OCR2A = green;
    TCCR2A |= 1 << COM2A1;
    OCR3C = blue;
    TCCR3A |= 1 << COM3C1;
}

void show_leds(uint8_t leds, uint8_t brightness) {
    tilenca_leds = brightness == 0 ? 0 : leds;
    if (brightness == 0 || brightness == 0xFF) {
        TIMSK4 = 1 << TOIE4;
    } else {
        OCR4A = compare_of(brightness, kClockTop);
        TIMSK4 = 1 << TOIE4 | 1 << OCIE4A;
    }
}

bool button_closed() {
    return !is_high(kButton);
}

} // namespace board
} // namespace tilenca
