// A queue of bytes between an interrupt and the main loop: one side only puts, the other only takes.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Holds kSize - 1 bytes; kSize is a power of two, at most 256, so that indices are single bytes and therefore
// never half-written when an interrupt looks.
template <uint16_t kSize>
struct Ring {
    static_assert(kSize <= 256 && (kSize & (kSize - 1)) == 0, "indices wrap by masking");
    static constexpr uint8_t kWrap = kSize - 1;

    bool empty() const { return head == tail; }

    uint8_t room() const { return static_cast<uint8_t>((tail - head - 1) & kWrap); }

    // Only when there is room().
    void put(uint8_t byte) {
        const uint8_t at = head;
        bytes[at] = byte;
        head = (at + 1) & kWrap;
    }

    // Only when not empty().
    uint8_t take() {
        const uint8_t at = tail;
        const uint8_t byte = bytes[at];
        tail = (at + 1) & kWrap;
        return byte;
    }

    // Plain members, since interrupts in assembly work on them too.
    volatile uint8_t head = 0; // where the next byte goes
    volatile uint8_t tail = 0; // the oldest byte
    volatile uint8_t bytes[kSize];
};

} // namespace board
} // namespace tilenca
