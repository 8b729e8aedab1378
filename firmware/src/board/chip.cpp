#include "board/chip.h"

#include <Arduino.h>
#include <avr/eeprom.h>
#include <avr/sleep.h>

namespace tilenca {
namespace board {

uint32_t now_ms() { return millis(); }

void sleep() {
    set_sleep_mode(SLEEP_MODE_IDLE);
    sleep_mode();
}

void read_eeprom(uint8_t* bytes, uint8_t size) { eeprom_read_block(bytes, nullptr, size); }

uint8_t take_reset_cause() {
    const uint8_t cause = MCUSR;
    MCUSR = 0;
    return cause;
}

} // namespace board
} // namespace tilenca
