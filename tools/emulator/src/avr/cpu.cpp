#include "avr/cpu.h"

#include "avr/ops.h"
#include "avr/vectors.h"

#include <algorithm>
#include <cstring>

namespace tilenca::avr {

namespace {

constexpr uint64_t kInterruptCycles = 5;   // with three bytes of return address
constexpr uint64_t kWakeCycles = 5;        // more, when the interrupt ends a sleep
constexpr uint64_t kLongestWait = 1 << 20; // of the start of a crystal, or of an access that stalls the core
constexpr uint32_t kMostDivisor = 256;

} // namespace

namespace ops {

void leave(TILENCA_STATE) {
    cpu->at = at;
    cpu->cycle = cycle;
    cpu->carry = carry;
    cpu->zero = zero;
    cpu->nvh = nvh;
}

void stop(TILENCA_STATE, const char* reason) {
    leave(cpu, at, cycle, carry, zero, nvh);
    cpu->fault = reason;
}

uint8_t read_slow(Cpu* cpu, uint16_t address, uint64_t cycle, uint32_t carry, uint32_t zero, uint32_t nvh) {
    if (address < kIoStart) {
        return cpu->data[address];
    }
    if (address == kStatus) {
        return cpu->status(carry, zero, nvh);
    }
    if (address >= kDataBytes) {
        cpu->bus->address_outside_memory(address, false);
        return 0;
    }
    const bool special = address < kSramStart && (cpu->special[address] & kReadsThroughBus) != 0;
    return special ? cpu->bus->read(address, cycle) : cpu->data[address];
}

void write_slow(Cpu* cpu, uint16_t address, uint8_t value, uint64_t cycle, uint32_t carry, uint32_t zero,
                uint32_t nvh) {
    cpu->carry = carry;
    cpu->zero = zero;
    cpu->nvh = nvh;
    if (address == kStatus) {
        write_status(cpu, value, cycle);
    } else if (address >= kDataBytes) {
        cpu->bus->address_outside_memory(address, true);
    } else if (address >= kIoStart && address < kSramStart &&
               (cpu->special[address] & kWritesThroughBus) != 0) {
        cpu->bus->write(address, value, cycle);
    } else {
        cpu->data[address] = value;
    }
}

} // namespace ops

void Cpu::use(const Program& program_image) {
    const uint32_t word = program == nullptr ? 0 : pc();
    program = program_image.instructions();
    image = &program_image;
    counts = program_image.counts();
    flash = program_image.bytes();
    at = program + word;
}

void Cpu::reset(uint32_t start_word) {
    at = program + start_word;
    set_status(0);
    requests = 0;
    held_until = 0;
    stall_cycles = 0;
    vector_base = 0;
    asleep = deeply = sleep_enabled = trap_hit = halted = stack_is_elsewhere = false;
    std::memset(data + kIoStart, 0, kSramStart - kIoStart);
    ops::set_pair(this, ops::kStackPointer, kDataBytes - 1);
    set_stack_low(std::max<uint16_t>(kDataBytes - 1, stack_floor));
    end_soon();
}

void Cpu::take_interrupt() {
    const auto vector = static_cast<uint8_t>(__builtin_ctzll(requests));
    if (asleep) {
        const uint64_t waking = kWakeCycles + wake_cycles;
        cycle += waking;
        sleep_cycles += waking;
        asleep = false;
        bus->sleep_changed(false, cycle);
    }
    cycle += kInterruptCycles;
    interrupts_on = false;
    const uint32_t word = pc();
    uint16_t top = ops::pair(this, ops::kStackPointer);
    const bool is_plain = ops::is_plain_push(this, top, 3);
    if (!is_plain && !grow_stack(top, static_cast<uint16_t>(top - 2))) {
        return;
    }
    for (unsigned i = 0; i < 3; i++, top--) {
        const auto byte = static_cast<uint8_t>(word >> (8 * i));
        if (is_plain) {
            data[top] = byte;
        } else {
            ops::write_slow(this, top, byte, cycle, carry, zero, nvh);
        }
    }
    ops::set_pair(this, ops::kStackPointer, top);
    at = program + vector_base + vector * 2;
    bus->interrupt_taken(vector, cycle);
}

// Executes instructions up to `limit`, at least one.
void Cpu::execute() {
    const Handler first = cycle < limit ? at->run : image->alone(pc());
    first(this, at, cycle, carry, zero, nvh);
    if (!trap_hit) {
        return;
    }
    trap_hit = false;
    if (bus->trapped(pc(), cycle)) {
        halted = true;
    } else {
        leave_breakpoint();
    }
}

void Cpu::leave_breakpoint() {
    halted = false;
    const uint32_t word = pc();
    bus->lift_trap(word, true);
    limit = 0;
    at->run(this, at, cycle, carry, zero, nvh);
    bus->lift_trap(word, false);
}

void Cpu::run(uint64_t until) {
    while (cycle < until && fault.empty() && !halted && !yields) {
        const uint64_t next_event = event_due > cycle ? event_due : bus->serve_events(cycle);
        if (cycle >= until) { // an event has reset the chip, which takes its time to start
            break;
        }
        const bool wanted = requests != 0 && interrupts_on;
        if (wanted && cycle > held_until) {
            take_interrupt();
            halt_if_asked();
            continue; // an event can have fallen due meanwhile, and rank first
        }
        limit = std::min(until, next_event);
        if (asleep && !wanted) {
            sleep_cycles += limit - cycle;
            cycle = limit;
            continue;
        }
        if (wanted || halts_after_one) {
            limit = std::min(limit, cycle + 1);
        }
        asleep = false;
        execute();
        halt_if_asked();
    }
}

void Cpu::step() {
    const uint64_t next_event = bus->serve_events(cycle);
    const bool wanted = requests != 0 && interrupts_on;
    if (wanted && cycle > held_until) {
        take_interrupt();
        return;
    }
    if (asleep) {
        sleep_cycles += next_event - cycle;
        cycle = next_event;
        return;
    }
    limit = 0;
    instructions++;
    execute();
}

void Cpu::state(Archive& archive) {
    uint32_t word = pc();
    archive.bytes(data, sizeof data);
    archive(word, cycle, carry, zero, nvh, requests, held_until, sleep_cycles, stall_cycles, vector_base);
    archive(interrupts_on, transfer, asleep, deeply, sleep_enabled, wake_cycles, instructions, fault);
    archive(stack_low, stack_floor, stack_deepest, stack_is_elsewhere, clock_divisor);
    archive.require(word <= kFlashWords + 1 && vector_base <= kFlashWords - 2 * kVectors &&
                        stack_low <= kDataBytes,
                    "it leads outside the memory");
    archive.require(requests >> kVectors == 0, "it asks for an interrupt that there is not");
    archive.require_range<uint64_t>(cycle, 0, kLastCycle, "its clock is beyond its end");
    archive.require(sleep_cycles <= cycle && std::max<uint64_t>(wake_cycles, stall_cycles) <= kLongestWait,
                    "it waits longer than a chip does");
    archive.require(clock_divisor != 0 && clock_divisor <= kMostDivisor &&
                        (clock_divisor & (clock_divisor - 1)) == 0,
                    "its clock is divided by what there is not");
    if (archive.loading()) {
        at = program + word;
        set_stack_low(stack_low);
        trap_hit = halted = false;
        yields = false;
    }
}

} // namespace tilenca::avr
