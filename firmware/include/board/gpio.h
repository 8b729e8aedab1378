// Digital pins by the pin map's port letter and bit.
#pragma once

#include <stdint.h>

#include "board/pins.h"

namespace tilenca {
namespace board {

// Data-space address of a port's PIN register; DDR is the next, PORT the one after (datasheet, register
// summary).
constexpr uint16_t pin_register(char port) {
    return port <= 'G' ? 0x20 + 3 * (port - 'A') : 0x100 + 3 * (port - (port > 'I' ? 'I' : 'H'));
}

static_assert(pin_register('A') == 0x20 && pin_register('G') == 0x32, "ports A to G follow each other");
static_assert(pin_register('H') == 0x100 && pin_register('J') == 0x103 && pin_register('L') == 0x109,
              "no port I");

inline volatile uint8_t& register_at(uint16_t address) {
    return *reinterpret_cast<volatile uint8_t*>(address);
}

inline volatile uint8_t& pin_of(Pin pin) {
    return register_at(pin_register(pin.port));
}
inline volatile uint8_t& ddr_of(Pin pin) {
    return register_at(pin_register(pin.port) + 1);
}
inline volatile uint8_t& port_of(Pin pin) {
    return register_at(pin_register(pin.port) + 2);
}

constexpr uint8_t mask_of(Pin pin) {
    return static_cast<uint8_t>(1 << pin.bit);
}

inline bool is_high(Pin pin) {
    return pin_of(pin) & mask_of(pin);
}

// Writing a 1 to the PIN register toggles one bit and leaves the others to the interrupts that may own them.
inline void set(Pin pin, bool high) {
    if (static_cast<bool>(port_of(pin) & mask_of(pin)) != high) {
        pin_of(pin) = mask_of(pin);
    }
}

// Only before interrupts that use the same port are on.
inline void make_output(Pin pin) {
    ddr_of(pin) |= mask_of(pin);
}

// A line that nobody drives then rests high instead of picking up noise.
inline void pull_up(Pin pin) {
    port_of(pin) |= mask_of(pin);
}

} // namespace board
} // namespace tilenca
