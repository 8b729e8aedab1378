#include "board/face.h"

#include <avr/io.h>

#include "board/gpio.h"
#include "board/south_uart.h"

namespace tilenca {
namespace board {

void face_begin() {
    for (Pin pin : kSegments) {
        make_output(pin);
    }
    for (Pin pin : kDebugLeds) {
        make_output(pin);
    }
    make_output(kRed);
    make_output(kGreen);
    make_output(kBlue);
    // Phase-correct 8-bit PWM at 490 Hz: unlike fast PWM it is fully dark at 0.
    TCCR2A = 1 << WGM20;
    TCCR2B = 1 << CS22;
    TCCR3A = 1 << WGM30;
    TCCR3B = 1 << CS31 | 1 << CS30;
    show_segments(0);
    show_colour(0, 0, 0);
}

void show_segments(uint8_t segments) {
    for (uint8_t i = 0; i < 8; ++i) {
        set(kSegments[i], segments >> i & 1);
    }
}

void show_colour(uint8_t red, uint8_t green, uint8_t blue) {
    // Red's timer runs at the south link's bit time and would blink shortly even at duty 0: off is off.
    if (red == 0) {
        TCCR1A &= ~(1 << COM1A1);
    } else {
        OCR1A = static_cast<uint16_t>(static_cast<uint32_t>(red) * kSouthBitCycles / 255 - 1);
        TCCR1A |= 1 << COM1A1;
    }
    OCR2A = green;
    TCCR2A |= 1 << COM2A1;
    OCR3C = blue;
    TCCR3A |= 1 << COM3C1;
}

void show_led(uint8_t index, bool lit) {
    set(kDebugLeds[index], lit);
}

bool button_closed() {
    return !is_high(kButton);
}

} // namespace board
} // namespace tilenca
