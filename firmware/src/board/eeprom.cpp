#include "board/eeprom.h"

#include <avr/interrupt.h>
#include <avr/io.h>

namespace tilenca {
namespace board {

namespace {

const uint8_t* to_write = nullptr;
uint8_t write_size = 0;
uint8_t written = 0; // how many of twice as many

uint8_t read_byte(uint8_t address) {
    EEAR = address;
    EECR = 1 << EERE;
    return EEDR;
}

void start_byte(uint8_t byte) {
    EEDR = byte; // EEAR is still that of the reading before
    const uint8_t interrupts = SREG;
    cli();
    EECR = 1 << EEMPE;
    EECR |= 1 << EEPE;
    SREG = interrupts;
}

} // namespace

void eeprom_read(Kept which, uint8_t* bytes, uint8_t size) {
    const uint8_t first = which == Kept::First ? 0 : size;
    for (uint8_t i = 0; i < size; ++i) {
        bytes[i] = read_byte(first + i);
    }
}

void eeprom_write(const uint8_t* bytes, uint8_t size) {
    to_write = bytes;
    write_size = size;
    written = 0;
}

bool eeprom_writing() {
    if (EECR & 1 << EEPE) {
        return true;
    }
    while (written < 2 * write_size) {
        const bool second = written < write_size;
        const uint8_t byte = to_write[second ? written : written - write_size];
        const uint8_t address = second ? write_size + written : written - write_size;
        ++written;
        if (read_byte(address) != byte) {
            start_byte(byte);
            return true;
        }
    }
    return false;
}

} // namespace board
} // namespace tilenca
