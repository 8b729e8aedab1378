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

// Reads every Stride-th byte, with no address arithmetic but one addition per byte.
template <uint8_t Stride>
class FlashColumn {
  public:
    explicit FlashColumn(const uint8_t* first) : next_(first) {}

    uint8_t next() {
#ifdef __AVR__
        uint8_t value;
        __asm__("lpm %0, %a1" : "=r"(value) : "z"(next_));
#else
        const uint8_t value = *next_;
#endif
        next_ += Stride;
        return value;
    }

  private:
    const uint8_t* next_;
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

    // The bytes from `index` on, each `Stride` behind the one before.
    template <uint8_t Stride>
    FlashColumn<Stride> column(uint16_t index) const {
        static_assert(sizeof(T) == 1, "only bytes can be streamed");
        return FlashColumn<Stride>(first_ + index);
    }

#ifdef __AVR__
    // Where in flash it begins, for assembly.
    uint16_t address() const { return reinterpret_cast<uint16_t>(first_); }
#endif

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
