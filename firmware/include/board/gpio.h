// Digital pins, by port letter and bit of the pin map.
#pragma once

#include <stdint.h>

#include "board/pins.h"

namespace tilenca {
namespace board {

// Data-space address of a port's PIN register. DDR and PORT follow it (datasheet, register summary).
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

// Writing a 1 to the PIN register toggles one bit. The others may belong to interrupts and stay untouched.
inline void set(Pin pin, bool high) {
    if (static_cast<bool>(port_of(pin) & mask_of(pin)) != high) {
        pin_of(pin) = mask_of(pin);
    }
}

// Call it before any interrupt that uses the same port is on: it reads, changes and writes the whole port.
inline void make_output(Pin pin) {
    ddr_of(pin) |= mask_of(pin);
}

// Keeps a line without a driver high, so that it picks up no noise. Call it before those interrupts, too.
inline void pull_up(Pin pin) {
    port_of(pin) |= mask_of(pin);
}

} // namespace board
} // namespace tilenca
