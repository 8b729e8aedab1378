// From opcodes to instructions: the table of the AVR instruction set, and the operands each form carries.
#include "avr/alu.h"
#include "avr/flow.h"
#include "avr/memory.h"
#include "avr/program.h"

#include <array>
#include <memory>

namespace tilenca::avr {

namespace {

// How the operands lie in the opcode.
enum class Form : uint8_t {
    None,
    TwoRegisters,    // ---- --rd dddd rrrr
    Constant,        // ---- KKKK dddd KKKK, d in 16..31
    OneRegister,     // ---- ---d dddd ----
    WordPair,        // ---- ---- KKdd KKKK, d in 24, 26, 28, 30
    MovePair,        // ---- ---- dddd rrrr, even registers
    UpperRegisters,  // ---- ---- dddd rrrr, 16..31
    MiddleRegisters, // ---- ---- -ddd -rrr, 16..23
    Displacement,    // --q- qq-d dddd -qqq
    RegisterBit,     // ---- ---d dddd -bbb
    IoBit,           // ---- ---- AAAA Abbb
    Io,              // ---- -AAd dddd AAAA
    Branch,          // ---- --kk kkkk k---
    StatusBit,       // ---- ---- -sss ----
    Relative,        // ---- kkkk kkkk kkkk
    Far,             // ---- ---k kkkk ---k and 16 bits more
    Address,         // ---- ---d dddd ---- and 16 bits more
};

struct Pattern {
    uint16_t mask;
    uint16_t value;
    Form form;
    Handler run;
};

using namespace ops;

constexpr Pattern kPatterns[] = {
    {0xFFFF, 0x0000, Form::None, nop},
    {0xFFFF, 0x9409, Form::None, ijmp},
    {0xFFFF, 0x9419, Form::None, eijmp},
    {0xFFFF, 0x9509, Form::None, icall},
    {0xFFFF, 0x9519, Form::None, eicall},
    {0xFFFF, 0x9508, Form::None, ret},
    {0xFFFF, 0x9518, Form::None, reti},
    {0xFFFF, 0x9588, Form::None, sleep},
    {0xFFFF, 0x9598, Form::None, break_},
    {0xFFFF, 0x95A8, Form::None, wdr},
    {0xFFFF, 0x95C8, Form::None, lpm},
    {0xFFFF, 0x95D8, Form::None, elpm},
    {0xFFFF, 0x95E8, Form::None, spm},
    {0xFFFF, 0x95F8, Form::None, spm_plus},
    {0xFFFF, 0x9478, Form::None, sei},
    {0xFFFF, 0x94F8, Form::None, cli},
    {0xFF8F, 0x9408, Form::StatusBit, bset},
    {0xFF8F, 0x9488, Form::StatusBit, bclr},
    {0xFF00, 0x0100, Form::MovePair, movw},
    {0xFF00, 0x0200, Form::UpperRegisters, muls},
    {0xFF88, 0x0300, Form::MiddleRegisters, mulsu},
    {0xFF88, 0x0308, Form::MiddleRegisters, fmul},
    {0xFF88, 0x0380, Form::MiddleRegisters, fmuls},
    {0xFF88, 0x0388, Form::MiddleRegisters, fmulsu},
    {0xFC00, 0x0400, Form::TwoRegisters, cpc},
    {0xFC00, 0x0800, Form::TwoRegisters, sbc},
    {0xFC00, 0x0C00, Form::TwoRegisters, add},
    {0xFC00, 0x1000, Form::TwoRegisters, cpse},
    {0xFC00, 0x1400, Form::TwoRegisters, cp},
    {0xFC00, 0x1800, Form::TwoRegisters, sub},
    {0xFC00, 0x1C00, Form::TwoRegisters, adc},
    {0xFC00, 0x2000, Form::TwoRegisters, and_},
    {0xFC00, 0x2400, Form::TwoRegisters, eor},
    {0xFC00, 0x2800, Form::TwoRegisters, or_},
    {0xFC00, 0x2C00, Form::TwoRegisters, mov},
    {0xFC00, 0x9C00, Form::TwoRegisters, mul},
    {0xF000, 0x3000, Form::Constant, cpi},
    {0xF000, 0x4000, Form::Constant, sbci},
    {0xF000, 0x5000, Form::Constant, subi},
    {0xF000, 0x6000, Form::Constant, ori},
    {0xF000, 0x7000, Form::Constant, andi},
    {0xF000, 0xE000, Form::Constant, ldi},
    {0xD208, 0x8000, Form::Displacement, ldd_z},
    {0xD208, 0x8008, Form::Displacement, ldd_y},
    {0xD208, 0x8200, Form::Displacement, std_z},
    {0xD208, 0x8208, Form::Displacement, std_y},
    {0xFE0F, 0x9000, Form::Address, lds},
    {0xFE0F, 0x9001, Form::OneRegister, ld_z_plus},
    {0xFE0F, 0x9002, Form::OneRegister, ld_minus_z},
    {0xFE0F, 0x9004, Form::OneRegister, lpm},
    {0xFE0F, 0x9005, Form::OneRegister, lpm_plus},
    {0xFE0F, 0x9006, Form::OneRegister, elpm},
    {0xFE0F, 0x9007, Form::OneRegister, elpm_plus},
    {0xFE0F, 0x9009, Form::OneRegister, ld_y_plus},
    {0xFE0F, 0x900A, Form::OneRegister, ld_minus_y},
    {0xFE0F, 0x900C, Form::OneRegister, ld_x},
    {0xFE0F, 0x900D, Form::OneRegister, ld_x_plus},
    {0xFE0F, 0x900E, Form::OneRegister, ld_minus_x},
    {0xFE0F, 0x900F, Form::OneRegister, pop},
    {0xFE0F, 0x9200, Form::Address, sts},
    {0xFE0F, 0x9201, Form::OneRegister, st_z_plus},
    {0xFE0F, 0x9202, Form::OneRegister, st_minus_z},
    {0xFE0F, 0x9209, Form::OneRegister, st_y_plus},
    {0xFE0F, 0x920A, Form::OneRegister, st_minus_y},
    {0xFE0F, 0x920C, Form::OneRegister, st_x},
    {0xFE0F, 0x920D, Form::OneRegister, st_x_plus},
    {0xFE0F, 0x920E, Form::OneRegister, st_minus_x},
    {0xFE0F, 0x920F, Form::OneRegister, push},
    {0xFE0F, 0x9400, Form::OneRegister, com},
    {0xFE0F, 0x9401, Form::OneRegister, neg},
    {0xFE0F, 0x9402, Form::OneRegister, swap},
    {0xFE0F, 0x9403, Form::OneRegister, inc},
    {0xFE0F, 0x9405, Form::OneRegister, asr},
    {0xFE0F, 0x9406, Form::OneRegister, lsr},
    {0xFE0F, 0x9407, Form::OneRegister, ror},
    {0xFE0F, 0x940A, Form::OneRegister, dec},
    {0xFE0E, 0x940C, Form::Far, jmp},
    {0xFE0E, 0x940E, Form::Far, call},
    {0xFF00, 0x9600, Form::WordPair, adiw},
    {0xFF00, 0x9700, Form::WordPair, sbiw},
    {0xFF00, 0x9800, Form::IoBit, cbi},
    {0xFF00, 0x9900, Form::IoBit, sbic},
    {0xFF00, 0x9A00, Form::IoBit, sbi},
    {0xFF00, 0x9B00, Form::IoBit, sbis},
    {0xF800, 0xB000, Form::Io, in},
    {0xF800, 0xB800, Form::Io, out},
    {0xF000, 0xC000, Form::Relative, rjmp},
    {0xF000, 0xD000, Form::Relative, rcall},
    {0xFE08, 0xF800, Form::RegisterBit, bld},
    {0xFE08, 0xFA00, Form::RegisterBit, bst},
    {0xFE08, 0xFC00, Form::RegisterBit, sbrc},
    {0xFE08, 0xFE00, Form::RegisterBit, sbrs},
};

// Branches by bit 10 (set or clear) and the three lowest bits (which flag).
constexpr Handler kBranches[2][8] = {
    {brcs, breq, brmi, brvs, brlt, brhs, brts, brie},
    {brcc, brne, brpl, brvc, brge, brhc, brtc, brid},
};

int32_t sign_extend(uint32_t value, unsigned bits) {
    const uint32_t sign = 1u << (bits - 1);
    return static_cast<int32_t>(value ^ sign) - static_cast<int32_t>(sign);
}

// A jump of `words` relative to the instruction after this one; what leaves flash lands on the end's sentinel
// or, as on the chip, comes in again at the other end.
int32_t relative(uint32_t word, int32_t words) {
    const uint32_t to = (word + 1 + static_cast<uint32_t>(words)) % kFlashWords;
    return static_cast<int32_t>(to) - static_cast<int32_t>(word);
}

void operands(Instruction& in, Form form, uint16_t op, uint16_t next, uint32_t word) {
    const auto five = static_cast<uint8_t>(op >> 4 & 31);
    const auto bit = static_cast<uint8_t>(1 << (op & 7));
    switch (form) {
    case Form::None:
    case Form::OneRegister:
        in.d = form == Form::None ? 0 : five;
        break;
    case Form::TwoRegisters:
        in.d = five;
        in.r = static_cast<uint8_t>((op & 15) | (op >> 5 & 16));
        break;
    case Form::Constant:
        in.d = static_cast<uint8_t>(16 + (op >> 4 & 15));
        in.r = static_cast<uint8_t>((op >> 4 & 0xF0) | (op & 15));
        break;
    case Form::WordPair:
        in.d = static_cast<uint8_t>(24 + (op >> 3 & 6));
        in.r = static_cast<uint8_t>((op >> 2 & 0x30) | (op & 15));
        break;
    case Form::MovePair:
        in.d = static_cast<uint8_t>(op >> 3 & 30);
        in.r = static_cast<uint8_t>(op << 1 & 30);
        break;
    case Form::UpperRegisters:
        in.d = static_cast<uint8_t>(16 + (op >> 4 & 15));
        in.r = static_cast<uint8_t>(16 + (op & 15));
        break;
    case Form::MiddleRegisters:
        in.d = static_cast<uint8_t>(16 + (op >> 4 & 7));
        in.r = static_cast<uint8_t>(16 + (op & 7));
        break;
    case Form::Displacement:
        in.d = five;
        in.k = static_cast<uint16_t>((op & 7) | (op >> 7 & 0x18) | (op >> 8 & 0x20));
        break;
    case Form::RegisterBit:
        in.d = five;
        in.r = bit;
        break;
    case Form::IoBit:
        in.k = static_cast<uint16_t>(kIoStart + (op >> 3 & 31));
        in.r = bit;
        break;
    case Form::Io:
        in.d = five;
        in.k = static_cast<uint16_t>(kIoStart + ((op & 15) | (op >> 5 & 0x30)));
        break;
    case Form::Branch:
        in.jump = relative(word, sign_extend(op >> 3 & 0x7F, 7));
        break;
    case Form::StatusBit:
        in.r = static_cast<uint8_t>(1 << (op >> 4 & 7));
        break;
    case Form::Relative:
        in.jump = relative(word, sign_extend(op & 0xFFF, 12));
        break;
    case Form::Far: {
        const uint32_t high = (op & 1u) | (op >> 3 & 0x3Eu);
        const uint32_t to = high << 16 | next;
        in.jump = static_cast<int32_t>(to < kFlashWords ? to : kFlashWords) - static_cast<int32_t>(word);
        break;
    }
    case Form::Address:
        in.d = five;
        in.k = next;
        break;
    }
}

bool is_skip(Handler run) {
    return run == cpse || run == sbrc || run == sbrs || run == sbic || run == sbis;
}

const Pattern* find(uint16_t opcode) {
    for (const Pattern& pattern : kPatterns) {
        if ((opcode & pattern.mask) == pattern.value) {
            return &pattern;
        }
    }
    return nullptr;
}

// One byte per opcode, so that decoding a flash costs no search. Built once.
const std::array<uint8_t, 65536>& pattern_of_opcode() {
    static const auto table = [] {
        auto made = std::make_unique<std::array<uint8_t, 65536>>();
        for (uint32_t opcode = 0; opcode < 65536; opcode++) {
            const Pattern* pattern = find(static_cast<uint16_t>(opcode));
            (*made)[opcode] = pattern == nullptr ? 0xFF : static_cast<uint8_t>(pattern - kPatterns);
        }
        return made;
    }();
    return *table;
}

} // namespace

bool is_two_words(uint16_t opcode) {
    return (opcode & 0xFC0F) == 0x9000 || (opcode & 0xFE0C) == 0x940C;
}

Instruction decode(uint16_t opcode, uint16_t next, uint32_t word) {
    Instruction in{illegal, 0, 0, 0, 0};
    if (opcode == kErased) {
        in.run = erased;
    } else if ((opcode & 0xF800) == 0xF000) {
        in.run = kBranches[opcode >> 10 & 1][opcode & 7];
        operands(in, Form::Branch, opcode, next, word);
    } else if (const uint8_t index = pattern_of_opcode()[opcode]; index != 0xFF) {
        in.run = kPatterns[index].run;
        operands(in, kPatterns[index].form, opcode, next, word);
        if (is_skip(in.run)) {
            in.jump = is_two_words(next) ? 3 : 2;
        } else if (in.k == kStatus && (in.run == ops::in || in.run == out)) {
            in.run = in.run == ops::in ? in_status : out_status;
        }
    }
    return in;
}

} // namespace tilenca::avr
