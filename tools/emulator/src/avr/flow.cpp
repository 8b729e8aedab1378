// Branches, skips, jumps, calls, bits of SREG, and what stops or rests the core.
#include "avr/flow.h"

namespace tilenca::avr::ops {

namespace {

const Instruction* target(const Cpu* cpu, uint32_t word) {
    return cpu->program + (word < kFlashWords ? word : kFlashWords);
}

// Calls that deepen the stack, and return addresses on one that is not in SRAM. Kept out of the handlers so
// that those need no stack frame.
TILENCA_OP(call_slow) {
    const uint16_t top = pair(cpu, kStackPointer);
    if (!cpu->grow_stack(top, static_cast<uint16_t>(top - 2))) {
        return leave(cpu, at, cycle, carry, zero, nvh);
    }
    for (unsigned i = 0; i < 3; i++) {
        const auto byte = static_cast<uint8_t>(cpu->return_word >> (8 * i));
        write_slow(cpu, static_cast<uint16_t>(top - i), byte, cycle, carry, zero, nvh);
    }
    set_pair(cpu, kStackPointer, top - 3u);
    return next(cpu, at, cycle, cpu->carry, cpu->zero, cpu->nvh);
}

TILENCA_OP(return_slow) {
    const uint16_t top = pair(cpu, kStackPointer);
    uint32_t word = 0;
    for (unsigned i = 1; i <= 3; i++) {
        word = word << 8 | read_slow(cpu, static_cast<uint16_t>(top + i), cycle, carry, zero, nvh);
    }
    set_pair(cpu, kStackPointer, top + 3u);
    at = target(cpu, word);
    TILENCA_NEXT(0, 5);
}

uint32_t extended_z(const Cpu* cpu) {
    return static_cast<uint32_t>(cpu->data[kEind] << 16 | pair(cpu, kZ));
}

} // namespace

TILENCA_OP(rjmp) {
    TILENCA_NEXT(at->jump, 2);
}
TILENCA_OP(jmp) {
    TILENCA_NEXT(at->jump, 3);
}
TILENCA_OP(ijmp) {
    at = target(cpu, pair(cpu, kZ));
    TILENCA_NEXT(0, 2);
}
TILENCA_OP(eijmp) {
    at = target(cpu, extended_z(cpu));
    TILENCA_NEXT(0, 2);
}
// The 22-bit return address takes three bytes, the lowest at the highest address.
#define TILENCA_CALL(words, to, cycles)                                                                      \
    const uint16_t top = pair(cpu, kStackPointer);                                                           \
    const auto word = static_cast<uint32_t>(at + (words) - cpu->program);                                    \
    at = (to);                                                                                               \
    if (__builtin_expect(!is_plain_push(cpu, top, 3), 0)) {                                                  \
        cpu->return_word = word;                                                                             \
        return call_slow(cpu, at, cycle + (cycles), carry, zero, nvh);                                       \
    }                                                                                                        \
    cpu->data[top] = static_cast<uint8_t>(word);                                                             \
    cpu->data[top - 1] = static_cast<uint8_t>(word >> 8);                                                    \
    cpu->data[top - 2] = static_cast<uint8_t>(word >> 16);                                                   \
    set_pair(cpu, kStackPointer, top - 3u);                                                                  \
    TILENCA_NEXT(0, cycles)

#define TILENCA_RETURN                                                                                       \
    const uint16_t top = pair(cpu, kStackPointer);                                                           \
    if (__builtin_expect(                                                                                    \
            !is_sram(static_cast<uint16_t>(top + 1)) || !is_sram(static_cast<uint16_t>(top + 3)), 0)) {      \
        return return_slow(cpu, at, cycle, carry, zero, nvh);                                                \
    }                                                                                                        \
    const uint8_t* const bytes = cpu->data + top;                                                            \
    set_pair(cpu, kStackPointer, top + 3u);                                                                  \
    at = target(cpu, static_cast<uint32_t>(bytes[1] << 16 | bytes[2] << 8 | bytes[3]));                      \
    TILENCA_NEXT(0, 5)

TILENCA_OP(rcall) {
    TILENCA_CALL(1, at + at->jump, 4);
}
TILENCA_OP(call) {
    TILENCA_CALL(2, at + at->jump, 5);
}
TILENCA_OP(icall) {
    TILENCA_CALL(1, target(cpu, pair(cpu, kZ)), 4);
}
TILENCA_OP(eicall) {
    TILENCA_CALL(1, target(cpu, extended_z(cpu)), 4);
}
TILENCA_OP(ret) {
    TILENCA_RETURN;
}

// After RETI, as after SEI, one more instruction runs before the next interrupt is taken.
TILENCA_OP(reti) {
    cpu->interrupts_on = true;
    cpu->held_until = cycle + 5;
    if (cpu->requests != 0) {
        cpu->end_soon();
    }
    TILENCA_RETURN;
}

// A skip takes one cycle, and one more for every word it skips.
#define TILENCA_SKIP_IF(condition)                                                                           \
    if (condition) {                                                                                         \
        TILENCA_NEXT(at->jump, static_cast<uint32_t>(at->jump));                                             \
    }                                                                                                        \
    TILENCA_NEXT(1, 1)

#define TILENCA_IO_BYTE                                                                                      \
    ((cpu->special[at->k] & kReadsThroughBus) != 0 ? read_slow(cpu, at->k, cycle, carry, zero, nvh)          \
                                                   : cpu->data[at->k])

TILENCA_OP(cpse) {
    TILENCA_SKIP_IF(cpu->data[at->d] == cpu->data[at->r]);
}
TILENCA_OP(sbrc) {
    TILENCA_SKIP_IF((cpu->data[at->d] & at->r) == 0);
}
TILENCA_OP(sbrs) {
    TILENCA_SKIP_IF(cpu->data[at->d] & at->r);
}
TILENCA_OP(sbic) {
    TILENCA_SKIP_IF((TILENCA_IO_BYTE & at->r) == 0);
}
TILENCA_OP(sbis) {
    TILENCA_SKIP_IF(TILENCA_IO_BYTE & at->r);
}

#define TILENCA_BRANCH(name, condition)                                                                      \
    TILENCA_OP(name) {                                                                                       \
        if (condition) {                                                                                     \
            TILENCA_NEXT(at->jump, 2);                                                                       \
        }                                                                                                    \
        TILENCA_NEXT(1, 1);                                                                                  \
    }

TILENCA_BRANCH(brcs, carry)
TILENCA_BRANCH(brcc, !carry)
TILENCA_BRANCH(breq, zero == 0)
TILENCA_BRANCH(brne, zero != 0)
TILENCA_BRANCH(brmi, is_negative(nvh))
TILENCA_BRANCH(brpl, !is_negative(nvh))
TILENCA_BRANCH(brvs, is_overflow(nvh))
TILENCA_BRANCH(brvc, !is_overflow(nvh))
TILENCA_BRANCH(brlt, is_signed_less(nvh))
TILENCA_BRANCH(brge, !is_signed_less(nvh))
TILENCA_BRANCH(brhs, is_half(nvh))
TILENCA_BRANCH(brhc, !is_half(nvh))
TILENCA_BRANCH(brts, cpu->transfer)
TILENCA_BRANCH(brtc, !cpu->transfer)
TILENCA_BRANCH(brie, cpu->interrupts_on)
TILENCA_BRANCH(brid, !cpu->interrupts_on)

// All bits of SREG go one way: through its written form, like a write to its address.
TILENCA_OP(bset) {
    const uint8_t old = read_slow(cpu, kStatus, cycle, carry, zero, nvh);
    write_slow(cpu, kStatus, old | at->r, cycle, carry, zero, nvh);
    return next(cpu, at + 1, cycle + 1, cpu->carry, cpu->zero, cpu->nvh);
}
// The two that programs use most take the short way; their effect is the same.
TILENCA_OP(sei) {
    if (!cpu->interrupts_on) {
        cpu->interrupts_on = true;
        cpu->held_until = cycle + 1;
        if (cpu->requests != 0) {
            cpu->end_soon();
        }
    }
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(cli) {
    cpu->interrupts_on = false;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(bclr) {
    const uint8_t old = read_slow(cpu, kStatus, cycle, carry, zero, nvh);
    write_slow(cpu, kStatus, static_cast<uint8_t>(old & ~at->r), cycle, carry, zero, nvh);
    return next(cpu, at + 1, cycle + 1, cpu->carry, cpu->zero, cpu->nvh);
}
TILENCA_OP(bst) {
    cpu->transfer = cpu->data[at->d] & at->r;
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(bld) {
    const uint8_t others = static_cast<uint8_t>(cpu->data[at->d] & ~at->r);
    cpu->data[at->d] = cpu->transfer ? others | at->r : others;
    TILENCA_NEXT(1, 1);
}

TILENCA_OP(nop) {
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(sleep) {
    if (cpu->sleep_enabled) {
        cpu->asleep = true;
        cpu->bus->sleep_changed(true, cycle);
        cpu->end_soon();
    }
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(wdr) {
    cpu->bus->watchdog_reset(cycle);
    TILENCA_NEXT(1, 1);
}
// Without a debugger attached, BREAK is a NOP.
TILENCA_OP(break_) {
    TILENCA_NEXT(1, 1);
}
// Lies over an instruction that a debugger wants to hear of.
TILENCA_OP(trap) {
    cpu->trap_hit = true;
    return leave(cpu, at, cycle, carry, zero, nvh);
}
TILENCA_OP(illegal) {
    return stop(cpu, at, cycle, carry, zero, nvh, "illegal instruction");
}
TILENCA_OP(erased) {
    return stop(cpu, at, cycle, carry, zero, nvh, "ran into erased flash");
}
TILENCA_OP(beyond_flash) {
    return stop(cpu, at, cycle, carry, zero, nvh, "ran off the end of flash");
}

} // namespace tilenca::avr::ops
