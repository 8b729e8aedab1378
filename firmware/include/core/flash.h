// Read-only data in flash, and the only header that knows how flash is read.
//
// On the AVR an ordinary pointer into flash compiles, but reads SRAM at that address. Therefore a FlashView
// never becomes a pointer, not even on the host, and code that forgets to read flash does not compile. Data
// declared with TILENCA_FLASH must lie in the low 64 KiB, which LPM can reach.
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

// Reads every Stride-th byte, at the price of one addition per byte.
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

// Values of type T in flash. The view has two bytes and does not own them.
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
// Without the library's loop, since firmware_id() looks up a table for every byte of the program.
template <>
inline uint32_t FlashView<uint32_t>::operator[](uint16_t index) const {
    return pgm_read_dword(first_ + index);
}
#endif

} // namespace tilenca
