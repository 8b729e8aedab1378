// Arithmetic and logic between registers and constants, and multiplication.
#include "avr/alu.h"

namespace tilenca::avr::ops {

#define TILENCA_ADD(source, carry_in)                                                                        \
    const uint32_t d = cpu->data[at->d], s = (source), sum = d + s + (carry_in), result = sum & 0xFF;        \
    cpu->data[at->d] = static_cast<uint8_t>(result);                                                         \
    nvh = pack(result, (d ^ result) & (s ^ result), d ^ s ^ result);                                         \
    carry = sum >> 8;                                                                                        \
    zero = result

#define TILENCA_SUBTRACT(source, borrow_in)                                                                  \
    const uint32_t d = cpu->data[at->d], s = (source), difference = d - s - (borrow_in);                     \
    const uint32_t result = difference & 0xFF;                                                               \
    nvh = pack(result, (d ^ s) & (d ^ result), d ^ s ^ result);                                              \
    carry = difference >> 31

#define TILENCA_KEEP cpu->data[at->d] = static_cast<uint8_t>(result)

TILENCA_OP(add) {
    TILENCA_ADD(cpu->data[at->r], 0);
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(adc) {
    TILENCA_ADD(cpu->data[at->r], carry);
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(sub) {
    TILENCA_SUBTRACT(cpu->data[at->r], 0);
    TILENCA_KEEP;
    zero = result;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(subi) {
    TILENCA_SUBTRACT(at->r, 0);
    TILENCA_KEEP;
    zero = result;
    TILENCA_NEXT(1, 1);
}
// With borrow, Z can only be cleared: it then tells of all bytes of a long number.
TILENCA_OP(sbc) {
    TILENCA_SUBTRACT(cpu->data[at->r], carry);
    TILENCA_KEEP;
    zero |= result;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(sbci) {
    TILENCA_SUBTRACT(at->r, carry);
    TILENCA_KEEP;
    zero |= result;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(cp) {
    TILENCA_SUBTRACT(cpu->data[at->r], 0);
    zero = result;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(cpc) {
    TILENCA_SUBTRACT(cpu->data[at->r], carry);
    zero |= result;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(cpi) {
    TILENCA_SUBTRACT(at->r, 0);
    zero = result;
    TILENCA_NEXT(1, 1);
}

TILENCA_OP(and_) {
    zero = cpu->data[at->d] &= cpu->data[at->r];
    nvh = logic(zero, nvh);
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(andi) {
    zero = cpu->data[at->d] &= at->r;
    nvh = logic(zero, nvh);
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(or_) {
    zero = cpu->data[at->d] |= cpu->data[at->r];
    nvh = logic(zero, nvh);
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(ori) {
    zero = cpu->data[at->d] |= at->r;
    nvh = logic(zero, nvh);
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(eor) {
    zero = cpu->data[at->d] ^= cpu->data[at->r];
    nvh = logic(zero, nvh);
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(com) {
    zero = cpu->data[at->d] = static_cast<uint8_t>(~cpu->data[at->d]);
    nvh = logic(zero, nvh);
    carry = 1;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(neg) {
    const uint32_t d = cpu->data[at->d], result = -d & 0xFF;
    TILENCA_KEEP;
    nvh = pack(result, d & result, d ^ result); // 0 - d
    carry = result != 0;
    zero = result;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(inc) {
    zero = ++cpu->data[at->d];
    nvh = logic(zero, nvh) | (zero == 0x80) << 15;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(dec) {
    zero = --cpu->data[at->d];
    nvh = logic(zero, nvh) | (zero == 0x7F) << 15;
    TILENCA_NEXT(1, 1);
}

// V = N ^ C after a shift to the right.
TILENCA_OP(lsr) {
    const uint32_t d = cpu->data[at->d], result = d >> 1;
    TILENCA_KEEP;
    carry = d & 1;
    nvh = logic(result, nvh) | carry << 15;
    zero = result;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(ror) {
    const uint32_t d = cpu->data[at->d], result = d >> 1 | carry << 7;
    TILENCA_KEEP;
    nvh = logic(result, nvh) | ((d ^ carry) & 1) << 15;
    carry = d & 1;
    zero = result;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(asr) {
    const uint32_t d = cpu->data[at->d], result = d >> 1 | (d & 0x80);
    TILENCA_KEEP;
    carry = d & 1;
    nvh = logic(result, nvh) | ((d >> 7 ^ d) & 1) << 15;
    zero = result;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(swap) {
    const uint32_t d = cpu->data[at->d], result = (d >> 4 | d << 4) & 0xFF;
    TILENCA_KEEP;
    TILENCA_NEXT(1, 1);
}

TILENCA_OP(adiw) {
    const uint32_t d = pair(cpu, at->d), sum = d + at->r, result = sum & 0xFFFF;
    set_pair(cpu, at->d, result);
    nvh = logic(result >> 8, nvh) | (~d & result & 0x8000);
    carry = sum >> 16;
    zero = result;
    TILENCA_NEXT(1, 2);
}
TILENCA_OP(sbiw) {
    const uint32_t d = pair(cpu, at->d), difference = d - at->r, result = difference & 0xFFFF;
    set_pair(cpu, at->d, result);
    nvh = logic(result >> 8, nvh) | (d & ~result & 0x8000);
    carry = difference >> 31;
    zero = result;
    TILENCA_NEXT(1, 2);
}

TILENCA_OP(ldi) {
    cpu->data[at->d] = at->r;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(mov) {
    cpu->data[at->d] = cpu->data[at->r];
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(movw) {
    const uint8_t low = cpu->data[at->r], high = cpu->data[at->r + 1];
    cpu->data[at->d] = low;
    cpu->data[at->d + 1] = high;
    TILENCA_NEXT(1, 1);
}

#define TILENCA_PRODUCT(left, right, shift)                                                                  \
    const uint32_t product = static_cast<uint32_t>((left) * (right)) & 0xFFFF;                               \
    carry = product >> 15;                                                                                   \
    zero = product << (shift) & 0xFFFF;                                                                      \
    set_pair(cpu, 0, zero);                                                                                  \
    TILENCA_NEXT(1, 2)

#define TILENCA_UNSIGNED(reg) static_cast<int32_t>(cpu->data[reg])
#define TILENCA_SIGNED(reg) static_cast<int32_t>(static_cast<int8_t>(cpu->data[reg]))

TILENCA_OP(mul) {
    TILENCA_PRODUCT(TILENCA_UNSIGNED(at->d), TILENCA_UNSIGNED(at->r), 0);
}
TILENCA_OP(muls) {
    TILENCA_PRODUCT(TILENCA_SIGNED(at->d), TILENCA_SIGNED(at->r), 0);
}
TILENCA_OP(mulsu) {
    TILENCA_PRODUCT(TILENCA_SIGNED(at->d), TILENCA_UNSIGNED(at->r), 0);
}
TILENCA_OP(fmul) {
    TILENCA_PRODUCT(TILENCA_UNSIGNED(at->d), TILENCA_UNSIGNED(at->r), 1);
}
TILENCA_OP(fmuls) {
    TILENCA_PRODUCT(TILENCA_SIGNED(at->d), TILENCA_SIGNED(at->r), 1);
}
TILENCA_OP(fmulsu) {
    TILENCA_PRODUCT(TILENCA_SIGNED(at->d), TILENCA_UNSIGNED(at->r), 1);
}

} // namespace tilenca::avr::ops
