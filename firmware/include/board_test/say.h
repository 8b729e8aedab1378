// Lines of text to the host, from flash.
#pragma once

#include <avr/pgmspace.h>
#include <stdint.h>

#include "board/pins.h"

namespace tilenca {

// Waits for room: nothing else here is in a hurry.
void say(char character);
void say(PGM_P text);
void say(board::Pin pin);        // PH4
void say_number(uint16_t value); // decimal
void say_hex(uint8_t value);     // two digits
void say_pass(PGM_P step);       // STEP: pass
void say_fail(PGM_P step);       // STEP: FAIL, and a blank
void say_end();                  // of the line

} // namespace tilenca
