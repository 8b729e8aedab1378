#include "avr/unmodelled.h"

namespace tilenca::avr {

namespace {

struct Register {
    uint16_t address;
    uint8_t asking_bits; // written as ones, they ask for the function
    const char* function;
};

constexpr Register kRegisters[] = {
    {0x4C, 0x40, "SPI (SPCR)"},
    {0x4E, 0xFF, "SPI (SPDR)"},
    {0x51, 0xFF, "on-chip debug register (OCDR)"},
    {0x61, 0x0F, "clock prescaler (CLKPR)"},
    {0x64, 0xFF, "power reduction (PRR0): everything stays on"},
    {0x65, 0xFF, "power reduction (PRR1): everything stays on"},
    {0x66, 0xFF, "oscillator calibration (OSCCAL)"},
    {0x74, 0x80, "external memory (XMCRA)"},
    {0xB6, 0x60, "asynchronous clock of timer 2 (ASSR)"},
    {0xBB, 0xFF, "TWI (TWDR)"},
    {0xBC, 0xA0, "TWI (TWCR)"},
    {0x50, 0x08, "analog comparator interrupt (ACSR)"},
};

} // namespace

const char* unmodelled_function(uint16_t address, uint8_t value) {
    for (const Register& one : kRegisters) {
        if (one.address == address && (value & one.asking_bits) != 0) {
            return one.function;
        }
    }
    return nullptr;
}

bool is_unmodelled(uint16_t address) {
    return unmodelled_function(address, 0xFF) != nullptr;
}

} // namespace tilenca::avr
