#include "board/eeprom.h"

#include <avr/interrupt.h>
#include <avr/io.h>

namespace tilenca {
namespace board {

namespace {

const uint8_t* to_write = nullptr;
uint8_t write_size = 0;
uint8_t write_at = 0; // next address

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

void eeprom_read(uint8_t* bytes, uint8_t size) {
    for (uint8_t address = 0; address < size; ++address) {
        bytes[address] = read_byte(address);
    }
}

void eeprom_write(const uint8_t* bytes, uint8_t size) {
    to_write = bytes;
    write_size = size;
    write_at = 0;
}

bool eeprom_writing() {
    if (EECR & 1 << EEPE) {
        return true;
    }
    while (write_at < write_size) {
        const uint8_t at = write_at++;
        if (read_byte(at) != to_write[at]) {
            start_byte(to_write[at]);
            return true;
        }
    }
    return false;
}

} // namespace board
} // namespace tilenca
