#include "avr/unmodelled.h"

namespace tilenca::avr {

namespace {

struct Register {
    uint16_t address;
    uint8_t asking_bits; // written as ones, they ask for the function
    const char* function;
};

constexpr Register kRegisters[] = {
    {0x51, 0xFF, "on-chip debug register (OCDR)"},
    {0x66, 0xFF, "oscillator calibration (OSCCAL)"},
    {0x74, 0x80, "external memory (XMCRA)"},
    {0xBA, 0xFE, "TWI as slave (TWAR): nobody addresses it"},
    {0xB6, 0x60, "asynchronous clock of timer 2 (ASSR)"},
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
