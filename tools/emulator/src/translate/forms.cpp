#include "translate/forms.h"

#include "avr/alu.h"
#include "avr/flow.h"
#include "avr/memory.h"

#include <unordered_map>

namespace tilenca::translate {

namespace {

using namespace avr::ops;

#define TILENCA_FLAGS "carry, zero, nvh"
#define TILENCA_WORD "w = word(%d, %D); "
#define TILENCA_X "word(r26, r27)"
#define TILENCA_Y "word(r28, r29)"
#define TILENCA_Z "word(r30, r31)"
#define TILENCA_KEEP_PRODUCT(left, right, shift)                                                             \
    "w = multiply(as_" left "(%d), as_" right "(%r), " shift ", carry, zero); put(r0, r1, w);"
#define TILENCA_AT(pointer) "a = " pointer "; %s "
#define TILENCA_AT_DISPLACED(pointer) "a = (" pointer " + %k) & 0xFFFF; %s "
#define TILENCA_THEN_UP(pointer, low, high) "a = " pointer "; %s put(" low ", " high ", (a + 1) & 0xFFFF); "
#define TILENCA_DOWN_THEN(pointer, low, high) "a = (" pointer " - 1) & 0xFFFF; %s put(" low ", " high ", a); "
#define TILENCA_LOAD "%d = DATA(a);"
#define TILENCA_FIND_RETURN "a = sp + 1; %s a = sp + 3; %s "
#define TILENCA_POP_RETURN                                                                                   \
    "w = DATA(sp + 1) << 16 | DATA(sp + 2) << 8 | DATA(sp + 3); sp = (sp + 3) & 0xFFFF;"
#define TILENCA_STORE "DATA(a) = static_cast<uint8_t>(%d);"

// The handler's address tells the instruction.
const std::unordered_map<avr::Handler, Form>& forms() {
    static const std::unordered_map<avr::Handler, Form> all = {
        {add, {Kind::Plain, "%d = add(%d, %r, 0, " TILENCA_FLAGS ");", 1}},
        {adc, {Kind::Plain, "%d = add(%d, %r, carry, " TILENCA_FLAGS ");", 1}},
        {sub, {Kind::Plain, "%d = subtract(%d, %r, " TILENCA_FLAGS ");", 1}},
        {subi, {Kind::Plain, "%d = subtract(%d, %c, " TILENCA_FLAGS ");", 1}},
        {sbc, {Kind::Plain, "%d = subtract_on(%d, %r, " TILENCA_FLAGS ");", 1}},
        {sbci, {Kind::Plain, "%d = subtract_on(%d, %c, " TILENCA_FLAGS ");", 1}},
        {cp, {Kind::Plain, "subtract(%d, %r, " TILENCA_FLAGS ");", 1}},
        {cpc, {Kind::Plain, "subtract_on(%d, %r, " TILENCA_FLAGS ");", 1}},
        {cpi, {Kind::Plain, "subtract(%d, %c, " TILENCA_FLAGS ");", 1}},
        {and_, {Kind::Plain, "%d = logical(%d & %r, zero, nvh);", 1}},
        {andi, {Kind::Plain, "%d = logical(%d & %c, zero, nvh);", 1}},
        {or_, {Kind::Plain, "%d = logical(%d | %r, zero, nvh);", 1}},
        {ori, {Kind::Plain, "%d = logical(%d | %c, zero, nvh);", 1}},
        {eor, {Kind::Plain, "%d = logical(%d ^ %r, zero, nvh);", 1}},
        {com, {Kind::Plain, "%d = complement(%d, " TILENCA_FLAGS ");", 1}},
        {neg, {Kind::Plain, "%d = negate(%d, " TILENCA_FLAGS ");", 1}},
        {inc, {Kind::Plain, "%d = increment(%d, zero, nvh);", 1}},
        {dec, {Kind::Plain, "%d = decrement(%d, zero, nvh);", 1}},
        {lsr, {Kind::Plain, "%d = shift_right(%d, " TILENCA_FLAGS ");", 1}},
        {ror, {Kind::Plain, "%d = rotate_right(%d, " TILENCA_FLAGS ");", 1}},
        {asr, {Kind::Plain, "%d = halve(%d, " TILENCA_FLAGS ");", 1}},
        {avr::ops::swap, {Kind::Plain, "%d = swap(%d);", 1}},
        {adiw, {Kind::Plain, TILENCA_WORD "w = add_word(w, %c, " TILENCA_FLAGS "); put(%d, %D, w);", 2}},
        {sbiw, {Kind::Plain, TILENCA_WORD "w = subtract_word(w, %c, " TILENCA_FLAGS "); put(%d, %D, w);", 2}},
        {ldi, {Kind::Plain, "%d = %c;", 1}},
        {mov, {Kind::Plain, "%d = %r;", 1}},
        {movw, {Kind::Plain, "put(%d, %D, word(%r, %R));", 1}},
        {mul, {Kind::Plain, TILENCA_KEEP_PRODUCT("unsigned", "unsigned", "0"), 2}},
        {muls, {Kind::Plain, TILENCA_KEEP_PRODUCT("signed", "signed", "0"), 2}},
        {mulsu, {Kind::Plain, TILENCA_KEEP_PRODUCT("signed", "unsigned", "0"), 2}},
        {fmul, {Kind::Plain, TILENCA_KEEP_PRODUCT("unsigned", "unsigned", "1"), 2}},
        {fmuls, {Kind::Plain, TILENCA_KEEP_PRODUCT("signed", "signed", "1"), 2}},
        {fmulsu, {Kind::Plain, TILENCA_KEEP_PRODUCT("signed", "unsigned", "1"), 2}},
        {bst, {Kind::Plain, "TRANSFER = (%d & %c) != 0;", 1}},
        {bld, {Kind::Plain, "%d = TRANSFER ? %d | %c : %d & %m;", 1}},
        {nop, {Kind::Plain, "", 1}},
        {cli, {Kind::Plain, "INTERRUPTS = false;", 1}},
        {in_status, {Kind::Plain, "%d = status(" TILENCA_FLAGS ", TRANSFER, INTERRUPTS);", 1}},

        {ld_x, {Kind::Plain, TILENCA_AT(TILENCA_X) TILENCA_LOAD, 2}},
        {ldd_y, {Kind::Plain, TILENCA_AT_DISPLACED(TILENCA_Y) TILENCA_LOAD, 2}},
        {ldd_z, {Kind::Plain, TILENCA_AT_DISPLACED(TILENCA_Z) TILENCA_LOAD, 2}},
        {st_x, {Kind::Plain, TILENCA_AT(TILENCA_X) TILENCA_STORE, 2}},
        {std_y, {Kind::Plain, TILENCA_AT_DISPLACED(TILENCA_Y) TILENCA_STORE, 2}},
        {std_z, {Kind::Plain, TILENCA_AT_DISPLACED(TILENCA_Z) TILENCA_STORE, 2}},
        {ld_x_plus, {Kind::Plain, TILENCA_THEN_UP(TILENCA_X, "r26", "r27") TILENCA_LOAD, 2}},
        {ld_y_plus, {Kind::Plain, TILENCA_THEN_UP(TILENCA_Y, "r28", "r29") TILENCA_LOAD, 2}},
        {ld_z_plus, {Kind::Plain, TILENCA_THEN_UP(TILENCA_Z, "r30", "r31") TILENCA_LOAD, 2}},
        {ld_minus_x, {Kind::Plain, TILENCA_DOWN_THEN(TILENCA_X, "r26", "r27") TILENCA_LOAD, 2}},
        {ld_minus_y, {Kind::Plain, TILENCA_DOWN_THEN(TILENCA_Y, "r28", "r29") TILENCA_LOAD, 2}},
        {ld_minus_z, {Kind::Plain, TILENCA_DOWN_THEN(TILENCA_Z, "r30", "r31") TILENCA_LOAD, 2}},
        {st_x_plus, {Kind::Plain, TILENCA_THEN_UP(TILENCA_X, "r26", "r27") TILENCA_STORE, 2}},
        {st_y_plus, {Kind::Plain, TILENCA_THEN_UP(TILENCA_Y, "r28", "r29") TILENCA_STORE, 2}},
        {st_z_plus, {Kind::Plain, TILENCA_THEN_UP(TILENCA_Z, "r30", "r31") TILENCA_STORE, 2}},
        {st_minus_x, {Kind::Plain, TILENCA_DOWN_THEN(TILENCA_X, "r26", "r27") TILENCA_STORE, 2}},
        {st_minus_y, {Kind::Plain, TILENCA_DOWN_THEN(TILENCA_Y, "r28", "r29") TILENCA_STORE, 2}},
        {st_minus_z, {Kind::Plain, TILENCA_DOWN_THEN(TILENCA_Z, "r30", "r31") TILENCA_STORE, 2}},
        {lds, {Kind::Plain, "%d = DATA(%k);", 2}},
        {sts, {Kind::Plain, "DATA(%k) = static_cast<uint8_t>(%d);", 2}},
        {push, {Kind::Plain, "%p DATA(sp) = static_cast<uint8_t>(%d); sp = (sp - 1) & 0xFFFF;", 2}},
        {pop, {Kind::Plain, "a = (sp + 1) & 0xFFFF; %s sp = a; " TILENCA_LOAD, 2}},
        {avr::ops::in, {Kind::Plain, "%d = DATA(%k);", 1}},
        {out, {Kind::Plain, "DATA(%k) = static_cast<uint8_t>(%d);", 1}},
        {sbi, {Kind::Plain, "DATA(%k) |= %c;", 2}},
        {cbi, {Kind::Plain, "DATA(%k) &= %m;", 2}},
        {lpm, {Kind::Plain, "a = " TILENCA_Z "; %d = FLASH[a];", 3, true}},
        {lpm_plus,
         {Kind::Plain, "a = " TILENCA_Z "; put(r30, r31, (a + 1) & 0xFFFF); %d = FLASH[a];", 3, true}},
        {elpm, {Kind::Plain, "a = (DATA(0x5B) & 3u) << 16 | " TILENCA_Z "; %l %d = FLASH[a];", 3}},
        {elpm_plus,
         {Kind::Plain,
          "a = (DATA(0x5B) & 3u) << 16 | " TILENCA_Z "; %l put(r30, r31, (a + 1) & 0xFFFF); "
          "DATA(0x5B) = static_cast<uint8_t>((a + 1) >> 16 & 3); %d = FLASH[a];",
          3}},

        {cpse, {Kind::Skip, "%d == %r", 1}},
        {sbrc, {Kind::Skip, "(%d & %c) == 0", 1}},
        {sbrs, {Kind::Skip, "(%d & %c) != 0", 1}},
        {sbic, {Kind::Skip, "(DATA(%k) & %c) == 0", 1}},
        {sbis, {Kind::Skip, "(DATA(%k) & %c) != 0", 1}},
        {brcs, {Kind::Branch, "carry != 0", 1}},
        {brcc, {Kind::Branch, "carry == 0", 1}},
        {breq, {Kind::Branch, "zero == 0", 1}},
        {brne, {Kind::Branch, "zero != 0", 1}},
        {brmi, {Kind::Branch, "is_negative(nvh)", 1}},
        {brpl, {Kind::Branch, "!is_negative(nvh)", 1}},
        {brvs, {Kind::Branch, "is_overflow(nvh)", 1}},
        {brvc, {Kind::Branch, "!is_overflow(nvh)", 1}},
        {brlt, {Kind::Branch, "is_signed_less(nvh)", 1}},
        {brge, {Kind::Branch, "!is_signed_less(nvh)", 1}},
        {brhs, {Kind::Branch, "is_half(nvh)", 1}},
        {brhc, {Kind::Branch, "!is_half(nvh)", 1}},
        {brts, {Kind::Branch, "TRANSFER", 1}},
        {brtc, {Kind::Branch, "!TRANSFER", 1}},
        {brie, {Kind::Branch, "INTERRUPTS", 1}},
        {brid, {Kind::Branch, "!INTERRUPTS", 1}},
        {rjmp, {Kind::Jump, "", 2}},
        {jmp, {Kind::Jump, "", 3}},
        {rcall, {Kind::Call, "", 4}},
        {call, {Kind::Call, "", 5}},
        {ijmp, {Kind::Dynamic, "w = " TILENCA_Z ";", 2}},
        {eijmp, {Kind::Dynamic, "w = DATA(0x5C) << 16 | " TILENCA_Z ";", 2}},
        {icall, {Kind::DynamicCall, "w = " TILENCA_Z ";", 4}},
        {eicall, {Kind::DynamicCall, "w = DATA(0x5C) << 16 | " TILENCA_Z ";", 4}},
        {ret, {Kind::Dynamic, TILENCA_FIND_RETURN TILENCA_POP_RETURN, 5}},
        {reti,
         {Kind::Dynamic,
          TILENCA_FIND_RETURN
          "INTERRUPTS = true; HELD_UNTIL = cycle + 5; if (REQUESTS != 0) LIMIT = 0; " TILENCA_POP_RETURN,
          5}},
        {out_status,
         {Kind::Plain,
          "w = %d; %i carry = carry_of(w); zero = zero_of(w); nvh = nvh_of(w); TRANSFER = (w & 0x40) != 0; "
          "INTERRUPTS = (w & 0x80) != 0;",
          1}},
        {sleep, {Kind::Interpreted, "", 1}},
        {illegal, {Kind::InterpretedEnd, "", 1}},
        {erased, {Kind::InterpretedEnd, "", 1}},
        {beyond_flash, {Kind::InterpretedEnd, "", 1}},
    };
    return all;
}

std::string reg(unsigned number) {
    return "r" + std::to_string(number);
}

// Whether an access is no more than one to memory.
bool is_stored(uint16_t address, uint8_t how, const uint8_t* special) {
    const bool is_io = address >= avr::kIoStart && address < avr::kSramStart;
    const bool is_stack_pointer = address == kStackPointer || address == kStackPointer + 1;
    return is_sram(address) || (is_io && !is_stack_pointer && (special[address] & how) == 0);
}

} // namespace

Form form_of(const avr::Instruction& in, const uint8_t* special) {
    const auto found = forms().find(in.run);
    if (found == forms().end()) {
        return {};
    }
    const bool reads = in.run == avr::ops::in || in.run == sbic || in.run == sbis;
    const bool writes = in.run == out || in.run == sbi || in.run == cbi;
    if (in.run == avr::ops::in && (in.k == kStackPointer || in.k == kStackPointer + 1)) {
        return {Kind::Plain, in.k == kStackPointer ? "%d = sp & 0xFF;" : "%d = sp >> 8;", 1};
    }
    const bool is_io = in.k >= avr::kIoStart && in.k < avr::kSramStart;
    if (is_io && (special[in.k] & avr::kChangesItsWay) != 0) {
        if (in.run == avr::ops::in || in.run == lds) {
            return {Kind::Plain, "%b %d = DATA(%k);", found->second.cycles};
        }
        if (in.run == out || in.run == sts) {
            return {Kind::Plain, "%B DATA(%k) = static_cast<uint8_t>(%d);", found->second.cycles};
        }
    }
    if ((reads && (special[in.k] & avr::kReadsThroughBus) != 0) ||
        (writes && (special[in.k] & avr::kWritesThroughBus) != 0) ||
        (in.run == lds && !is_stored(in.k, avr::kReadsThroughBus, special)) ||
        (in.run == sts && !is_stored(in.k, avr::kWritesThroughBus, special))) {
        return {};
    }
    return found->second;
}

std::string filled(const Form& form, const avr::Instruction& in, const std::string& leave) {
    std::string text;
    for (const char* c = form.text; *c != 0; c++) {
        if (*c != '%') {
            text += *c;
            continue;
        }
        switch (*++c) {
        case 'd':
            text += reg(in.d);
            break;
        case 'D':
            text += reg(in.d + 1u);
            break;
        case 'r':
            text += reg(in.r);
            break;
        case 'R':
            text += reg(in.r + 1u);
            break;
        case 'c':
            text += std::to_string(in.r);
            break;
        case 'm':
            text += std::to_string(~in.r & 0xFF);
            break;
        case 'k':
            text += std::to_string(in.k);
            break;
        case 's':
            text += "if (RARE(!IS_SRAM(a))) " + leave;
            break;
        case 'b':
            text += "if (RARE((SPECIAL(" + std::to_string(in.k) + ") & 1) != 0)) " + leave;
            break;
        case 'B':
            text += "if (RARE((SPECIAL(" + std::to_string(in.k) + ") & 2) != 0)) " + leave;
            break;
        case 'i':
            text += "if (RARE((w & 0x80) != 0 && !INTERRUPTS)) " + leave;
            break;
        case 'l':
            text += "if (RARE(a >= FLASH_LIMIT)) " + leave;
            break;
        case 'p':
            text += "if (RARE(!IS_PLAIN_PUSH(sp, 1))) " + leave;
            break;
        default:
            break;
        }
    }
    return text;
}

} // namespace tilenca::translate
