// A queue of bytes between an interrupt and the main loop: one side only puts, the other only takes.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Holds kSize - 1 bytes; kSize is a power of two, at most 256, so that indices are single bytes and therefore
// never half-written when an interrupt looks.
template <uint16_t kSize>
class Ring {
  public:
    bool empty() const { return head_ == tail_; }

    uint8_t room() const { return static_cast<uint8_t>((tail_ - head_ - 1) & kMask); }

    // A byte for which there is no room is dropped.
    void put(uint8_t byte) {
        const uint8_t head = head_;
        const uint8_t next = (head + 1) & kMask;
        if (next != tail_) {
            bytes_[head] = byte;
            head_ = next;
        }
    }

    // Only when not empty().
    uint8_t take() {
        const uint8_t tail = tail_;
        const uint8_t byte = bytes_[tail];
        tail_ = (tail + 1) & kMask;
        return byte;
    }

  private:
    static_assert(kSize <= 256 && (kSize & (kSize - 1)) == 0, "indices wrap by masking");
    static constexpr uint8_t kMask = kSize - 1;

    volatile uint8_t head_ = 0;
    volatile uint8_t tail_ = 0;
    volatile uint8_t bytes_[kSize];
};

} // namespace board
} // namespace tilenca
