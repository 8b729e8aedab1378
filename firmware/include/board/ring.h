// Queues of bytes between an interrupt and the main loop. One of them only puts, the other one only takes.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Memory for queues. Its address is a multiple of 256, so that an index is the low byte of a pointer. An
// interrupt then needs no arithmetic and does not have to save the flags.
struct Page {
    volatile uint8_t bytes[256];
} __attribute__((aligned(256)));

// Keeps pages together, since between other variables each page would have a gap before it.
#define TILENCA_PAGE __attribute__((section(".bss.pages")))

// A queue of at most kSize - 1 bytes, one of 256 / kSize in its page. An index is a single byte, so an
// interrupt never sees a half-written one.
template <uint16_t kSize>
struct Ring {
    static_assert(kSize <= 256 && (kSize & (kSize - 1)) == 0, "indices wrap by masking");
    static constexpr uint8_t kWrap = kSize - 1;

    // The index after this one, in the same part of the page.
    static uint8_t after(uint8_t at) { return static_cast<uint8_t>((at & ~kWrap) | ((at + 1) & kWrap)); }

    // Empties the queue, whose bytes begin at `first` in the page. Only while its interrupt is off.
    void begin(uint8_t first) { head = tail = first; }

    bool empty() const { return head == tail; }

    uint8_t room() const { return static_cast<uint8_t>((tail - head - 1) & kWrap); }

    // Only when there is room().
    void put(Page& page, uint8_t byte) {
        const uint8_t at = head;
        page.bytes[at] = byte;
        head = after(at);
    }

    // Only when not empty().
    uint8_t take(const Page& page) {
        const uint8_t at = tail;
        const uint8_t byte = page.bytes[at];
        tail = after(at);
        return byte;
    }

    // Public, since interrupts in assembly use them.
    volatile uint8_t head = 0; // where the next byte goes
    volatile uint8_t tail = 0; // the oldest byte
};

} // namespace board
} // namespace tilenca
