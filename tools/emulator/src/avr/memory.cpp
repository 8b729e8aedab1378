// Loads, stores, the stack, I/O space and program memory.
#include "avr/memory.h"

namespace tilenca::avr::ops {

namespace {

// Accesses outside SRAM, kept out of the handlers so that those need no stack frame. The address travels in
// the Cpu: a seventh argument would make the call a true one. The data access happens in an instruction's
// last cycle.
template <int words, int cycles>
TILENCA_OP(load_slow) {
    cycle += cycles - 1;
    cpu->data[at->d] = read_slow(cpu, cpu->address, cycle, carry, zero, nvh);
    cycle += cpu->stall_cycles + 1;
    cpu->stall_cycles = 0;
    TILENCA_NEXT(words, 0);
}

// IN and OUT of a register that a peripheral answers for.
TILENCA_OP(in_slow) {
    cpu->data[at->d] = cpu->bus->read(at->k, cycle);
    cycle += cpu->stall_cycles + 1;
    cpu->stall_cycles = 0;
    TILENCA_NEXT(1, 0);
}

TILENCA_OP(out_slow) {
    cpu->bus->write(at->k, cpu->data[at->d], cycle);
    cycle += cpu->stall_cycles + 1;
    cpu->stall_cycles = 0;
    TILENCA_NEXT(1, 0);
}

template <int words, int cycles>
TILENCA_OP(store_slow) {
    cycle += cycles - 1;
    write_slow(cpu, cpu->address, cpu->data[at->d], cycle, carry, zero, nvh);
    cycle += cpu->stall_cycles + 1;
    cpu->stall_cycles = 0;
    return next(cpu, at + words, cycle, cpu->carry, cpu->zero, cpu->nvh);
}

template <bool value>
TILENCA_OP(write_bit_slow) {
    cpu->bus->write_bit(at->k, at->r, value, cycle + 1);
    cycle += cpu->stall_cycles;
    cpu->stall_cycles = 0;
    TILENCA_NEXT(1, 2);
}

TILENCA_OP(load_program_slow) {
    const auto word = static_cast<uint32_t>(at - cpu->program);
    cpu->data[at->d] = cpu->bus->read_program_memory(word, cpu->flash_address);
    TILENCA_NEXT(1, 3);
}

// A push that deepens the stack, or is not into SRAM.
TILENCA_OP(push_slow) {
    const uint16_t top = pair(cpu, kStackPointer);
    if (!cpu->grow_stack(top, top)) {
        return leave(cpu, at, cycle, carry, zero, nvh);
    }
    set_pair(cpu, kStackPointer, top - 1u);
    cpu->address = top;
    return store_slow<1, 2>(cpu, at, cycle, carry, zero, nvh);
}

uint32_t far_z(const Cpu* cpu) {
    return static_cast<uint32_t>((cpu->data[kRampZ] & 3) << 16 | pair(cpu, kZ));
}

} // namespace

#define TILENCA_LOAD(address_expression)                                                                     \
    const auto address = static_cast<uint16_t>(address_expression);                                          \
    if (__builtin_expect(!is_sram(address), 0)) {                                                            \
        cpu->address = address;                                                                              \
        return load_slow<1, 2>(cpu, at, cycle, carry, zero, nvh);                                            \
    }                                                                                                        \
    cpu->data[at->d] = cpu->data[address];                                                                   \
    TILENCA_NEXT(1, 2)

#define TILENCA_LOAD_PROGRAM(address_expression)                                                             \
    const uint32_t address = (address_expression);                                                           \
    if (__builtin_expect(address >= cpu->flash_limit, 0)) {                                                  \
        cpu->flash_address = address;                                                                        \
        return load_program_slow(cpu, at, cycle, carry, zero, nvh);                                          \
    }                                                                                                        \
    cpu->data[at->d] = cpu->flash[address];                                                                  \
    TILENCA_NEXT(1, 3)

#define TILENCA_STORE(address_expression)                                                                    \
    const auto address = static_cast<uint16_t>(address_expression);                                          \
    if (__builtin_expect(!is_sram(address), 0)) {                                                            \
        cpu->address = address;                                                                              \
        return store_slow<1, 2>(cpu, at, cycle, carry, zero, nvh);                                           \
    }                                                                                                        \
    cpu->data[address] = cpu->data[at->d];                                                                   \
    TILENCA_NEXT(1, 2)

TILENCA_OP(ld_x) {
    TILENCA_LOAD(pair(cpu, kX));
}
TILENCA_OP(ldd_y) {
    TILENCA_LOAD(pair(cpu, kY) + at->k);
}
TILENCA_OP(ldd_z) {
    TILENCA_LOAD(pair(cpu, kZ) + at->k);
}
TILENCA_OP(st_x) {
    TILENCA_STORE(pair(cpu, kX));
}
TILENCA_OP(std_y) {
    TILENCA_STORE(pair(cpu, kY) + at->k);
}
TILENCA_OP(std_z) {
    TILENCA_STORE(pair(cpu, kZ) + at->k);
}

#define TILENCA_STEPPING(name, action, pointer, before, after)                                               \
    TILENCA_OP(name) {                                                                                       \
        const auto stepped = static_cast<uint16_t>(pair(cpu, pointer) + (before));                           \
        set_pair(cpu, pointer, static_cast<uint16_t>(stepped + (after)));                                    \
        action(stepped);                                                                                     \
    }

TILENCA_STEPPING(ld_x_plus, TILENCA_LOAD, kX, 0, 1)
TILENCA_STEPPING(ld_y_plus, TILENCA_LOAD, kY, 0, 1)
TILENCA_STEPPING(ld_z_plus, TILENCA_LOAD, kZ, 0, 1)
TILENCA_STEPPING(ld_minus_x, TILENCA_LOAD, kX, -1, 0)
TILENCA_STEPPING(ld_minus_y, TILENCA_LOAD, kY, -1, 0)
TILENCA_STEPPING(ld_minus_z, TILENCA_LOAD, kZ, -1, 0)
TILENCA_STEPPING(st_x_plus, TILENCA_STORE, kX, 0, 1)
TILENCA_STEPPING(st_y_plus, TILENCA_STORE, kY, 0, 1)
TILENCA_STEPPING(st_z_plus, TILENCA_STORE, kZ, 0, 1)
TILENCA_STEPPING(st_minus_x, TILENCA_STORE, kX, -1, 0)
TILENCA_STEPPING(st_minus_y, TILENCA_STORE, kY, -1, 0)
TILENCA_STEPPING(st_minus_z, TILENCA_STORE, kZ, -1, 0)

TILENCA_OP(lds) {
    if (__builtin_expect(!is_sram(at->k), 0)) {
        cpu->address = at->k;
        return load_slow<2, 2>(cpu, at, cycle, carry, zero, nvh);
    }
    cpu->data[at->d] = cpu->data[at->k];
    TILENCA_NEXT(2, 2);
}
TILENCA_OP(sts) {
    if (__builtin_expect(!is_sram(at->k), 0)) {
        cpu->address = at->k;
        return store_slow<2, 2>(cpu, at, cycle, carry, zero, nvh);
    }
    cpu->data[at->k] = cpu->data[at->d];
    TILENCA_NEXT(2, 2);
}
TILENCA_OP(push) {
    const uint16_t top = pair(cpu, kStackPointer);
    if (__builtin_expect(!is_plain_push(cpu, top, 1), 0)) {
        return push_slow(cpu, at, cycle, carry, zero, nvh);
    }
    set_pair(cpu, kStackPointer, top - 1u);
    cpu->data[top] = cpu->data[at->d];
    TILENCA_NEXT(1, 2);
}
TILENCA_OP(pop) {
    const auto top = static_cast<uint16_t>(pair(cpu, kStackPointer) + 1);
    set_pair(cpu, kStackPointer, top);
    TILENCA_LOAD(top);
}

TILENCA_OP(in) {
    if (__builtin_expect(cpu->special[at->k] & kReadsThroughBus, 0)) {
        return in_slow(cpu, at, cycle, carry, zero, nvh);
    }
    cpu->data[at->d] = cpu->data[at->k];
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(out) {
    if (__builtin_expect(cpu->special[at->k] & kWritesThroughBus, 0)) {
        return out_slow(cpu, at, cycle, carry, zero, nvh);
    }
    cpu->data[at->k] = cpu->data[at->d];
    TILENCA_NEXT(1, 1);
}
// SREG holds no byte of its own, so it is read and written by handlers of its own.
TILENCA_OP(in_status) {
    cpu->data[at->d] = cpu->status(carry, zero, nvh);
    TILENCA_NEXT(1, 1);
}
TILENCA_OP(out_status) {
    static_cast<void>(carry); // it and the other two are in the new SREG
    static_cast<void>(zero);
    static_cast<void>(nvh);
    write_status(cpu, cpu->data[at->d], cycle);
    return next(cpu, at + 1, cycle + 1, cpu->carry, cpu->zero, cpu->nvh);
}
TILENCA_OP(sbi) {
    if ((cpu->special[at->k] & kWritesThroughBus) != 0) {
        return write_bit_slow<true>(cpu, at, cycle, carry, zero, nvh);
    }
    cpu->data[at->k] |= at->r;
    TILENCA_NEXT(1, 2);
}
TILENCA_OP(cbi) {
    if ((cpu->special[at->k] & kWritesThroughBus) != 0) {
        return write_bit_slow<false>(cpu, at, cycle, carry, zero, nvh);
    }
    cpu->data[at->k] &= static_cast<uint8_t>(~at->r);
    TILENCA_NEXT(1, 2);
}

TILENCA_OP(lpm) {
    TILENCA_LOAD_PROGRAM(pair(cpu, kZ));
}
TILENCA_OP(lpm_plus) {
    const uint16_t z = pair(cpu, kZ);
    set_pair(cpu, kZ, z + 1u);
    TILENCA_LOAD_PROGRAM(z);
}
TILENCA_OP(elpm) {
    TILENCA_LOAD_PROGRAM(far_z(cpu));
}
TILENCA_OP(elpm_plus) {
    const uint32_t z = far_z(cpu);
    set_pair(cpu, kZ, z + 1);
    cpu->data[kRampZ] = static_cast<uint8_t>((z + 1) >> 16 & 3);
    TILENCA_LOAD_PROGRAM(z);
}
// SPM can replace the program: where to go on is worked out afresh.
TILENCA_OP(spm) {
    const auto word = static_cast<uint32_t>(at - cpu->program);
    cycle += cpu->bus->store_program_memory(word, cycle, false);
    return next(cpu, cpu->program + word + 1, cycle, carry, zero, nvh);
}
TILENCA_OP(spm_plus) {
    const auto word = static_cast<uint32_t>(at - cpu->program);
    cycle += cpu->bus->store_program_memory(word, cycle, true);
    return next(cpu, cpu->program + word + 1, cycle, carry, zero, nvh);
}

} // namespace tilenca::avr::ops
