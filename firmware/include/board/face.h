// What a person sees of a tile and can press: digit, colour, debug LEDs, button.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Call it before links_begin(), whose interrupts use ports of the display. Nothing is lit before
// clock_begin() and links_begin() have started timers 4 and 1, which dim some of the segments and red.
void face_begin();

// Bit 0 = segment a ... bit 6 = g, bit 7 = dp; brightness of 255, 0 is dark. The decimal point
// cannot be dimmed.
void show_segments(uint8_t segments, uint8_t brightness = 255);

// Duty of 255 each; 0 is dark.
void show_colour(uint8_t red, uint8_t green, uint8_t blue);

// One of the four debug LEDs, in the order N E S W.
void show_led(uint8_t index, bool lit);

bool button_closed();

} // namespace board
} // namespace tilenca
