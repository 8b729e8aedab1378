#include "board/eeprom.h"

#include <avr/interrupt.h>
#include <avr/io.h>

namespace tilenca {
namespace board {

bool Eeprom::busy() {
    return EECR & 1 << EEPE;
}

uint8_t Eeprom::read(uint8_t address) {
    EEAR = address;
    EECR = 1 << EERE;
    return EEDR;
}

void Eeprom::write(uint8_t address, uint8_t byte) {
    EEAR = address;
    EEDR = byte;
    const uint8_t interrupts = SREG;
    cli(); // the second must come within four cycles
    EECR = 1 << EEMPE;
    EECR |= 1 << EEPE;
    SREG = interrupts;
}

} // namespace board
} // namespace tilenca
