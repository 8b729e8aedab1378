// What arithmetic and logic make of their operands: results and flags, of the interpreter's instructions and
// of translated ones.
//
// Needs nothing but fixed-size integers: translated blocks take this text along. Flags are unfinished, as
// avr/instruction.h has them.
#include <cstdint>

namespace tilenca::avr::effects {

#define TILENCA_EFFECT [[gnu::always_inline, maybe_unused]] static inline

constexpr uint32_t kHalfCarryMask = 0xFF0000;

// N from `result`, V from bit 7 of `overflow`, H from bit 4 of `half`; all three at most 8 bits wide.
TILENCA_EFFECT uint32_t pack(uint32_t result, uint32_t overflow, uint32_t half) {
    return result | overflow << 8 | half << 16;
}

// A result that clears V and leaves H alone.
TILENCA_EFFECT uint32_t logic(uint32_t result, uint32_t nvh) {
    return result | (nvh & kHalfCarryMask);
}

TILENCA_EFFECT bool is_negative(uint32_t nvh) {
    return nvh & 0x80;
}
TILENCA_EFFECT bool is_overflow(uint32_t nvh) {
    return nvh & 0x8000;
}
TILENCA_EFFECT bool is_half(uint32_t nvh) {
    return nvh & 0x100000;
}
TILENCA_EFFECT bool is_signed_less(uint32_t nvh) {
    return (nvh >> 7 ^ nvh >> 15 ^ nvh >> 31) & 1;
}

TILENCA_EFFECT uint32_t status(uint32_t carry, uint32_t zero, uint32_t nvh, bool transfer, bool interrupts) {
    return carry | uint32_t{zero == 0} << 1 | uint32_t{is_negative(nvh)} << 2 |
           uint32_t{is_overflow(nvh)} << 3 | uint32_t{is_signed_less(nvh)} << 4 |
           uint32_t{is_half(nvh)} << 5 | uint32_t{transfer} << 6 | uint32_t{interrupts} << 7;
}

// Of a value that a program writes to SREG: C and Z as above, and N, V, H and S.
TILENCA_EFFECT uint32_t carry_of(uint32_t status) {
    return status & 1;
}
TILENCA_EFFECT uint32_t zero_of(uint32_t status) {
    return (status & 2) == 0;
}
TILENCA_EFFECT uint32_t nvh_of(uint32_t status) {
    const uint32_t sign_differs = (status >> 4 ^ status >> 3 ^ status >> 2) & 1;
    return pack((status & 4) << 5, (status & 8) << 4, (status & 0x20) >> 1) | sign_differs << 31;
}

// --- two operands ---

TILENCA_EFFECT uint32_t add(uint32_t d, uint32_t s, uint32_t carry_in, uint32_t& carry, uint32_t& zero,
                            uint32_t& nvh) {
    const uint32_t sum = d + s + carry_in, result = sum & 0xFF;
    nvh = pack(result, (d ^ result) & (s ^ result), d ^ s ^ result);
    carry = sum >> 8;
    zero = result;
    return result;
}
TILENCA_EFFECT uint32_t subtract(uint32_t d, uint32_t s, uint32_t& carry, uint32_t& zero, uint32_t& nvh) {
    const uint32_t difference = d - s, result = difference & 0xFF;
    nvh = pack(result, (d ^ s) & (d ^ result), d ^ s ^ result);
    carry = difference >> 31;
    zero = result;
    return result;
}
// With borrow, Z can only be cleared: it then tells of all bytes of a long number.
TILENCA_EFFECT uint32_t subtract_on(uint32_t d, uint32_t s, uint32_t& carry, uint32_t& zero, uint32_t& nvh) {
    const uint32_t difference = d - s - carry, result = difference & 0xFF;
    nvh = pack(result, (d ^ s) & (d ^ result), d ^ s ^ result);
    carry = difference >> 31;
    zero |= result;
    return result;
}
TILENCA_EFFECT uint32_t logical(uint32_t result, uint32_t& zero, uint32_t& nvh) {
    zero = result;
    nvh = logic(result, nvh);
    return result;
}

// Numbers of so many bits, as if they were added byte by byte with carry; likewise subtracted.
template <unsigned bits>
TILENCA_EFFECT uint32_t add_wide(uint32_t d, uint32_t s, uint32_t& carry, uint32_t& zero, uint32_t& nvh) {
    constexpr unsigned highest = bits - 8;
    const uint64_t sum = uint64_t{d} + s;
    const auto result = static_cast<uint32_t>(sum & ((uint64_t{1} << bits) - 1));
    nvh = pack(result >> highest, ((d ^ result) & (s ^ result)) >> highest, (d ^ s ^ result) >> highest);
    carry = static_cast<uint32_t>(sum >> bits);
    zero = result >> highest; // of the highest byte only
    return result;
}
template <unsigned bits>
TILENCA_EFFECT uint32_t subtract_wide(uint32_t d, uint32_t s, uint32_t& carry, uint32_t& zero,
                                      uint32_t& nvh) {
    constexpr unsigned highest = bits - 8;
    const auto result = static_cast<uint32_t>((uint64_t{d} - s) & ((uint64_t{1} << bits) - 1));
    nvh = pack(result >> highest, ((d ^ s) & (d ^ result)) >> highest, (d ^ s ^ result) >> highest);
    carry = d < s;
    zero = (result | result >> 8 | result >> 16 | result >> 24) & 0xFF;
    return result;
}

// --- one operand ---

TILENCA_EFFECT uint32_t complement(uint32_t d, uint32_t& carry, uint32_t& zero, uint32_t& nvh) {
    carry = 1;
    return logical(~d & 0xFF, zero, nvh);
}
TILENCA_EFFECT uint32_t negate(uint32_t d, uint32_t& carry, uint32_t& zero, uint32_t& nvh) {
    const uint32_t result = -d & 0xFF;
    nvh = pack(result, d & result, d ^ result); // 0 - d
    carry = result != 0;
    zero = result;
    return result;
}
TILENCA_EFFECT uint32_t increment(uint32_t d, uint32_t& zero, uint32_t& nvh) {
    zero = (d + 1) & 0xFF;
    nvh = logic(zero, nvh) | uint32_t{zero == 0x80} << 15;
    return zero;
}
TILENCA_EFFECT uint32_t decrement(uint32_t d, uint32_t& zero, uint32_t& nvh) {
    zero = (d - 1) & 0xFF;
    nvh = logic(zero, nvh) | uint32_t{zero == 0x7F} << 15;
    return zero;
}
// V = N ^ C after a shift to the right.
TILENCA_EFFECT uint32_t shift_right(uint32_t d, uint32_t& carry, uint32_t& zero, uint32_t& nvh) {
    const uint32_t result = d >> 1;
    carry = d & 1;
    nvh = logic(result, nvh) | carry << 15;
    zero = result;
    return result;
}
TILENCA_EFFECT uint32_t rotate_right(uint32_t d, uint32_t& carry, uint32_t& zero, uint32_t& nvh) {
    const uint32_t result = d >> 1 | carry << 7;
    nvh = logic(result, nvh) | ((d ^ carry) & 1) << 15;
    carry = d & 1;
    zero = result;
    return result;
}
TILENCA_EFFECT uint32_t halve(uint32_t d, uint32_t& carry, uint32_t& zero, uint32_t& nvh) {
    const uint32_t result = d >> 1 | (d & 0x80);
    carry = d & 1;
    nvh = logic(result, nvh) | ((d >> 7 ^ d) & 1) << 15;
    zero = result;
    return result;
}
TILENCA_EFFECT uint32_t swap(uint32_t d) {
    return (d >> 4 | d << 4) & 0xFF;
}

// --- pairs ---

TILENCA_EFFECT uint32_t add_word(uint32_t d, uint32_t s, uint32_t& carry, uint32_t& zero, uint32_t& nvh) {
    const uint32_t sum = d + s, result = sum & 0xFFFF;
    nvh = logic(result >> 8, nvh) | (~d & result & 0x8000);
    carry = sum >> 16;
    zero = result;
    return result;
}
TILENCA_EFFECT uint32_t subtract_word(uint32_t d, uint32_t s, uint32_t& carry, uint32_t& zero,
                                      uint32_t& nvh) {
    const uint32_t difference = d - s, result = difference & 0xFFFF;
    nvh = logic(result >> 8, nvh) | (d & ~result & 0x8000);
    carry = difference >> 31;
    zero = result;
    return result;
}
TILENCA_EFFECT int32_t as_signed(uint32_t d) {
    return static_cast<int8_t>(d);
}
TILENCA_EFFECT int32_t as_unsigned(uint32_t d) {
    return static_cast<int32_t>(d);
}
TILENCA_EFFECT uint32_t multiply(int32_t left, int32_t right, unsigned shift, uint32_t& carry,
                                 uint32_t& zero) {
    const uint32_t product = static_cast<uint32_t>(left * right) & 0xFFFF;
    carry = product >> 15;
    zero = product << shift & 0xFFFF;
    return zero;
}

} // namespace tilenca::avr::effects
