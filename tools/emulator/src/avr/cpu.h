// The core of the chip: registers, data memory, program counter, interrupts, sleep.
//
// Knows no peripheral. Accesses to I/O registers that do more than store a byte go through `Bus`.
#pragma once

#include "avr/archive.h"
#include "avr/instruction.h"
#include "avr/program.h"

#include <cstdint>
#include <string>

namespace tilenca::avr {

constexpr uint16_t kIoStart = 0x20;
constexpr uint16_t kSramStart = 0x200;
constexpr uint16_t kSramBytes = 0x2000;
constexpr uint16_t kDataBytes = kSramStart + kSramBytes;
constexpr uint64_t kNever = ~uint64_t{0};
constexpr uint64_t kLastCycle = uint64_t{1} << 62; // a chip that runs for ever does not reach it
// I/O addresses whose access goes through the bus.
constexpr uint8_t kReadsThroughBus = 1, kWritesThroughBus = 2;
// Whether it does changes while the chip runs.
constexpr uint8_t kChangesItsWay = 4;

// What the core needs from the rest of the chip.
struct Bus {
    virtual ~Bus() = default;
    virtual uint8_t read(uint16_t address, uint64_t cycle) = 0;
    virtual void write(uint16_t address, uint8_t value, uint64_t cycle) = 0;
    // SBI and CBI: touches no other bit, so that flags cleared by writing a one survive their neighbours.
    virtual void write_bit(uint16_t address, uint8_t mask, bool value, uint64_t cycle) = 0;
    // Serves everything due at or before `cycle`; returns when the next event is due.
    virtual uint64_t serve_events(uint64_t cycle) = 0;
    virtual void interrupt_taken(uint8_t vector, uint64_t cycle) = 0;
    virtual void watchdog_reset(uint64_t cycle) = 0;
    // SPM at that word; returns the cycles it took.
    virtual uint32_t store_program_memory(uint32_t word, uint64_t cycle, bool advance_z) = 0;
    // LPM and ELPM at that word, at or beyond `flash_limit`.
    virtual uint8_t read_program_memory(uint32_t word, uint32_t address) = 0;
    virtual void address_outside_memory(uint16_t address, bool write) = 0;
    // SLEEP was executed, or an interrupt ends the sleep.
    virtual void sleep_changed(bool asleep, uint64_t cycle) = 0;
    // A trap was set on the instruction at that word: whether the core stops before it.
    virtual bool trapped(uint32_t word, uint64_t cycle) = 0;
    // Puts the instruction under a trap in its place, or the trap over it again.
    virtual void lift_trap(uint32_t word, bool lifted) = 0;
};

struct Cpu {
    uint8_t data[kDataBytes];    // first, so that a register's address is its number
    uint64_t limit = 0;          // the cycle at which the running instructions hand control back
    uint8_t special[kSramStart]; // kReadsThroughBus, kWritesThroughBus, kChangesItsWay
    const Instruction* program = nullptr;
    const Program* image = nullptr; // which `program` belongs to
    Counts* counts = nullptr;       // of its instructions, if they are counted
    const uint8_t* flash = nullptr;
    uint32_t flash_limit = 0; // what lies beyond is not to be read without asking the bus
    // Pushes into [stack_low, stack_low + stack_room) are plain; all others are looked at.
    uint16_t stack_low = kDataBytes, stack_room = 0;
    Bus* bus = nullptr;

    // Where execution stands; valid while no instruction runs.
    const Instruction* at = nullptr;
    uint64_t cycle = 0;
    uint32_t carry = 0, zero = 1, nvh = 0;

    uint64_t event_due = 0; // of the next event; 0: not known, the bus has to be asked
    uint64_t requests = 0;  // bit v: interrupt vector v asks to be served
    uint64_t held_until =
        0; // no interrupt is taken at or before this cycle: the instruction after SEI runs first
    uint64_t sleep_cycles = 0;
    uint32_t stall_cycles = 0;           // cycles an I/O access stops the core for
    uint32_t vector_base = 0;            // word address of vector 0
    uint16_t address = 0;                // of the access outside SRAM under way
    uint32_t return_word = 0;            // of the call under way, when the stack is outside SRAM
    uint32_t flash_address = 0;          // of the read under way, when it lies beyond `flash_limit`
    uint64_t wake_cycles = 0;            // what it takes to end this sleep, besides the interrupt's own
    uint16_t stack_floor = kSramStart;   // the stack shall not grow below
    uint16_t stack_deepest = kDataBytes; // the lowest address it has used
    bool stack_is_elsewhere = false;     // a task's own, among the data
    bool interrupts_on = false;
    bool transfer = false; // the T flag
    bool asleep = false;
    bool deeply = false; // asleep, and the clock of the peripherals stands
    bool sleep_enabled = false;
    bool trap_hit = false;        // the instruction at hand is a trap that has not been looked at yet
    bool yields = false;          // returns control to the caller, which clears this
    uint32_t clock_divisor = 1;   // of the system clock prescaler
    bool halts_after_one = false; // instruction, or interrupt taken
    bool halted = false;          // before a breakpoint, until the debugger goes on
    uint64_t instructions = 0;    // counted by single steps only
    std::string fault;            // what stopped the core; empty: nothing

    void use(const Program& program_image);
    void reset(uint32_t start_word);
    // Runs until `until` is reached or passed by the last instruction; stops earlier at a fault.
    void run(uint64_t until);
    // Executes one instruction, or takes one interrupt.
    void step();
    // Goes on from a breakpoint: the instruction there is executed, and no other.
    void leave_breakpoint();
    uint8_t status() const { return status(carry, zero, nvh); }
    uint8_t status(uint32_t with_carry, uint32_t with_zero, uint32_t with_nvh) const;
    void set_status(uint8_t value);
    uint32_t pc() const { return static_cast<uint32_t>(at - program); }
    // Raises or withdraws a request; noticed before the next instruction.
    void request(uint8_t vector, bool active) {
        request_all(uint64_t{1} << vector, uint64_t{active} << vector);
    }
    // The same for all vectors of a mask: those in `asking` ask, the others of the mask do not.
    void request_all(uint64_t mask, uint64_t asking) {
        const uint64_t fresh = asking & ~requests;
        requests = (requests & ~mask) | asking;
        if (fresh != 0 && interrupts_on) {
            end_soon();
        }
    }
    void end_soon() { limit = 0; }
    void fail(const std::string& reason) {
        fault = reason;
        end_soon();
    }
    // The stack is about to grow from `from` down to `lowest`. False, and a fault: it meets the data.
    bool grow_stack(uint16_t from, uint16_t lowest);
    // A program has written its stack pointer.
    void stack_pointer_written(uint16_t from, uint16_t to);
    void set_stack_floor(uint16_t floor);
    void state(Archive& archive);

  private:
    void take_interrupt();
    void set_stack_low(uint16_t low);
    void execute();
    void halt_if_asked() {
        halted = halted || halts_after_one;
        halts_after_one = false;
    }
};

} // namespace tilenca::avr
