// Arithmetic and logic between registers and constants, and multiplication.
#include "avr/alu.h"

namespace tilenca::avr::ops {

TILENCA_OP(add) {
    cpu->data[at->d] =
        static_cast<uint8_t>(effects::add(cpu->data[at->d], cpu->data[at->r], 0, carry, zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(adc) {
    cpu->data[at->d] =
        static_cast<uint8_t>(effects::add(cpu->data[at->d], cpu->data[at->r], carry, carry, zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(sub) {
    cpu->data[at->d] =
        static_cast<uint8_t>(effects::subtract(cpu->data[at->d], cpu->data[at->r], carry, zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(subi) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::subtract(cpu->data[at->d], at->r, carry, zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(sbc) {
    cpu->data[at->d] =
        static_cast<uint8_t>(effects::subtract_on(cpu->data[at->d], cpu->data[at->r], carry, zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(sbci) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::subtract_on(cpu->data[at->d], at->r, carry, zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(cp) {
    effects::subtract(cpu->data[at->d], cpu->data[at->r], carry, zero, nvh);
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(cpc) {
    effects::subtract_on(cpu->data[at->d], cpu->data[at->r], carry, zero, nvh);
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(cpi) {
    effects::subtract(cpu->data[at->d], at->r, carry, zero, nvh);
    TILENCA_NEXT(1, 1);
}

TILENCA_OP(and_) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::logical(cpu->data[at->d] & cpu->data[at->r], zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(andi) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::logical(cpu->data[at->d] & at->r, zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(or_) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::logical(cpu->data[at->d] | cpu->data[at->r], zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(ori) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::logical(cpu->data[at->d] | at->r, zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(eor) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::logical(cpu->data[at->d] ^ cpu->data[at->r], zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(com) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::complement(cpu->data[at->d], carry, zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(neg) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::negate(cpu->data[at->d], carry, zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(inc) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::increment(cpu->data[at->d], zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(dec) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::decrement(cpu->data[at->d], zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(lsr) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::shift_right(cpu->data[at->d], carry, zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(ror) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::rotate_right(cpu->data[at->d], carry, zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(asr) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::halve(cpu->data[at->d], carry, zero, nvh));
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(swap) {
    cpu->data[at->d] = static_cast<uint8_t>(effects::swap(cpu->data[at->d]));
    TILENCA_NEXT(1, 1);
}

TILENCA_OP(adiw) {
    set_pair(cpu, at->d, effects::add_word(pair(cpu, at->d), at->r, carry, zero, nvh));
    TILENCA_NEXT(1, 2);
}
TILENCA_OP(sbiw) {
    set_pair(cpu, at->d, effects::subtract_word(pair(cpu, at->d), at->r, carry, zero, nvh));
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

TILENCA_OP(mul) {
    set_pair(cpu, 0,
             effects::multiply(effects::as_unsigned(cpu->data[at->d]), effects::as_unsigned(cpu->data[at->r]),
                               0, carry, zero));
    TILENCA_NEXT(1, 2);
}
TILENCA_OP(muls) {
    set_pair(cpu, 0,
             effects::multiply(effects::as_signed(cpu->data[at->d]), effects::as_signed(cpu->data[at->r]), 0,
                               carry, zero));
    TILENCA_NEXT(1, 2);
}
TILENCA_OP(mulsu) {
    set_pair(cpu, 0,
             effects::multiply(effects::as_signed(cpu->data[at->d]), effects::as_unsigned(cpu->data[at->r]),
                               0, carry, zero));
    TILENCA_NEXT(1, 2);
}
TILENCA_OP(fmul) {
    set_pair(cpu, 0,
             effects::multiply(effects::as_unsigned(cpu->data[at->d]), effects::as_unsigned(cpu->data[at->r]),
                               1, carry, zero));
    TILENCA_NEXT(1, 2);
}
TILENCA_OP(fmuls) {
    set_pair(cpu, 0,
             effects::multiply(effects::as_signed(cpu->data[at->d]), effects::as_signed(cpu->data[at->r]), 1,
                               carry, zero));
    TILENCA_NEXT(1, 2);
}
TILENCA_OP(fmulsu) {
    set_pair(cpu, 0,
             effects::multiply(effects::as_signed(cpu->data[at->d]), effects::as_unsigned(cpu->data[at->r]),
                               1, carry, zero));
    TILENCA_NEXT(1, 2);
}

} // namespace tilenca::avr::ops
