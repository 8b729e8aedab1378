// The display and the button: digit, colour, debug LEDs.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Call it before links_begin(), whose interrupts use ports of the display. Nothing is lit before
// clock_begin() and links_begin() have started timers 4 and 1, which dim some of the segments and red.
void display_begin();

// Bit 0 = segment a ... bit 6 = g, bit 7 = dp. Brightness is 0..255, and 0 is dark. The decimal point cannot
// be dimmed.
void show_segments(uint8_t segments, uint8_t brightness = 255);

// Duties of 0..255.
void show_colour(uint8_t red, uint8_t green, uint8_t blue);

// The debug LEDs, one bit each in the order N E S W. Each is lit for at most a quarter of the time, never two
// at once. Brightness is 0..255, and that of the segments too unless it is 0 or 255.
void show_leds(uint8_t leds, uint8_t brightness = 255);

bool button_closed();

} // namespace board
} // namespace tilenca
