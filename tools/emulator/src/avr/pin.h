// A pin of a port, and what whoever is at the other end of its wire does to it.
#pragma once

#include <cstdint>

namespace tilenca::avr {

constexpr unsigned kPorts = 11; // A B C D E F G H J K L

struct PinId {
    uint8_t port;
    uint8_t bit;

    constexpr uint8_t mask() const { return static_cast<uint8_t>(1 << bit); }
    constexpr bool operator==(const PinId& other) const { return port == other.port && bit == other.bit; }
};

// Index of a port letter; there is no port I.
constexpr uint8_t port_index(char letter) {
    return static_cast<uint8_t>(letter < 'I' ? letter - 'A' : letter - 'B');
}

// Open: nobody drives the wire, so a pull-up lifts it, and without one it floats. Middle: something holds it
// between the two levels, where a pull-up is too weak: it reads as noise.
enum class Drive : uint8_t { Low, High, Open, Middle };
constexpr Drive last_of(Drive) {
    return Drive::Middle;
}

constexpr Drive drive_of(bool level) {
    return level ? Drive::High : Drive::Low;
}
constexpr bool is_driven(Drive drive) {
    return drive <= Drive::High;
}

} // namespace tilenca::avr
