// What all instruction handlers share: their signature, the way to the next one, flags, registers and memory.
#pragma once

#include "avr/cpu.h"
#include "avr/effects.h"

namespace tilenca::avr::ops {

#define TILENCA_STATE                                                                                        \
    Cpu *cpu, const Instruction *at, uint64_t cycle, uint32_t carry, uint32_t zero, uint32_t nvh
#define TILENCA_OP(name) void name(TILENCA_STATE)
// Ends a handler: goes on `words` further, `cycles` later. A macro, since it passes on the handler's six
// arguments.
#define TILENCA_NEXT(words, cycles) return next(cpu, at + (words), cycle + (cycles), carry, zero, nvh)

// Stores the state and returns to Cpu::run.
void leave(TILENCA_STATE);
// Stops the core at this instruction with a reason.
void stop(TILENCA_STATE, const char* reason);

[[gnu::always_inline]] inline void next(TILENCA_STATE) {
    if (__builtin_expect(cycle >= cpu->limit, 0)) {
        return leave(cpu, at, cycle, carry, zero, nvh);
    }
    return at->run(cpu, at, cycle, carry, zero, nvh);
}

using effects::is_half;
using effects::is_negative;
using effects::is_overflow;
using effects::is_signed_less;
using effects::pack;

// Two bytes rather than one 16-bit load, which the compiler would make of it: the pair is often written byte
// by byte just before, and the host would have to wait for both stores.
inline uint16_t pair(const Cpu* cpu, unsigned reg) {
    const volatile uint8_t* bytes = cpu->data + reg;
    const unsigned low = bytes[0], high = bytes[1];
    return static_cast<uint16_t>(low | high << 8);
}

inline void set_pair(Cpu* cpu, unsigned reg, uint32_t value) {
    cpu->data[reg] = static_cast<uint8_t>(value);
    cpu->data[reg + 1] = static_cast<uint8_t>(value >> 8);
}

constexpr unsigned kX = 26, kY = 28, kZ = 30;
constexpr unsigned kRampZ = 0x5B, kEind = 0x5C, kStackPointer = 0x5D, kStatus = 0x5F;

inline bool is_sram(uint16_t address) {
    return static_cast<uint16_t>(address - kSramStart) < kSramBytes;
}

// Whether `count` bytes pushed from `top` down go where the stack has been before.
inline bool is_plain_push(const Cpu* cpu, uint16_t top, uint16_t count) {
    const auto lowest = static_cast<uint16_t>(top - count + 1);
    return static_cast<uint16_t>(lowest - cpu->stack_low) + count <= cpu->stack_room;
}

// A program writes SREG, whose flags then stand in the Cpu.
inline void write_status(Cpu* cpu, uint8_t value, uint64_t cycle) {
    if ((value & 0x80) != 0 && !cpu->interrupts_on) {
        cpu->held_until = cycle + 1;
        if (cpu->requests != 0) {
            cpu->end_soon();
        }
    }
    cpu->set_status(value);
}

// Memory outside SRAM. They keep the state in `cpu` (SREG is part of memory) and add to cpu->stall_cycles.
uint8_t read_slow(Cpu* cpu, uint16_t address, uint64_t cycle, uint32_t carry, uint32_t zero, uint32_t nvh);
void write_slow(Cpu* cpu, uint16_t address, uint8_t value, uint64_t cycle, uint32_t carry, uint32_t zero,
                uint32_t nvh);

} // namespace tilenca::avr::ops

namespace tilenca::avr {

inline uint8_t Cpu::status(uint32_t with_carry, uint32_t with_zero, uint32_t with_nvh) const {
    return static_cast<uint8_t>(effects::status(with_carry, with_zero, with_nvh, transfer, interrupts_on));
}

inline void Cpu::set_status(uint8_t value) {
    carry = effects::carry_of(value);
    zero = effects::zero_of(value);
    nvh = effects::nvh_of(value);
    transfer = (value & 0x40) != 0;
    interrupts_on = (value & 0x80) != 0;
}

} // namespace tilenca::avr
