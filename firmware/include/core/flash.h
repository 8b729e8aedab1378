// Read-only data in flash, and the only header that knows how flash is read.
//
// The AVR cannot read flash through an ordinary pointer: that compiles and returns whatever SRAM holds at the
// address. A FlashView therefore never becomes a pointer, on no machine, so that a forgotten flash read does
// not compile, natively included. Data declared with TILENCA_FLASH must lie in the low 64 KiB, where LPM
// reaches.
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __AVR__
#include <avr/pgmspace.h>
#define TILENCA_FLASH PROGMEM
#else
#include <string.h>
#define TILENCA_FLASH
#endif

namespace tilenca {

// Reads consecutive bytes. A stream needs no address arithmetic per byte, which halves the network's inner
// loop.
class FlashBytes {
  public:
    explicit FlashBytes(const int8_t* first) : next_(first) {}

    int8_t next() {
#ifdef __AVR__
        int8_t value;
        __asm__("lpm %0, Z+" : "=r"(value), "+z"(next_));
        return value;
#else
        return *next_++;
#endif
    }

  private:
    const int8_t* next_;
};

// Values of type T that live in flash; the view is two bytes and does not own them.
template <typename T>
class FlashView {
  public:
    constexpr explicit FlashView(const T* first) : first_(first) {}

    T operator[](uint16_t index) const {
        T value;
#ifdef __AVR__
        memcpy_P(&value, first_ + index, sizeof(T));
#else
        memcpy(&value, first_ + index, sizeof(T));
#endif
        return value;
    }

    // A stream of bytes that begins at `index`.
    FlashBytes bytes_from(uint16_t index) const {
        static_assert(sizeof(T) == 1, "only bytes can be streamed");
        return FlashBytes(first_ + index);
    }

  private:
    const T* first_;
};

#ifdef __AVR__
// Without the library's loop: a table that is looked up for every byte of something.
template <>
inline uint32_t FlashView<uint32_t>::operator[](uint16_t index) const {
    return pgm_read_dword(first_ + index);
}
#endif

} // namespace tilenca
