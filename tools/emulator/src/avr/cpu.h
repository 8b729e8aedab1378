// The core of the chip: registers, data memory, program counter, interrupts, sleep.
//
// Knows no peripheral. Accesses to I/O registers that do more than store a byte go through `Bus`.
#pragma once

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
    // LPM and ELPM, while `flash` is null.
    virtual uint8_t read_program_memory(uint32_t address) = 0;
    virtual void address_outside_memory(uint16_t address, bool write) = 0;
};

struct Cpu {
    uint8_t data[kDataBytes]; // first, so that a register's address is its number
    uint64_t limit = 0;       // the cycle at which the running instructions hand control back
    bool special[kSramStart]; // I/O addresses whose access goes through the bus
    const Instruction* program = nullptr;
    const uint8_t* flash = nullptr; // null: not to be read without asking the bus
    Bus* bus = nullptr;

    // Where execution stands; valid while no instruction runs.
    const Instruction* at = nullptr;
    uint64_t cycle = 0;
    uint32_t carry = 0, zero = 1, nvh = 0;

    uint64_t requests = 0; // bit v: interrupt vector v asks to be served
    uint64_t held_until =
        0; // no interrupt is taken at or before this cycle: the instruction after SEI runs first
    uint64_t sleep_cycles = 0;
    uint32_t stall_cycles = 0;  // cycles an I/O access stops the core for
    uint32_t vector_base = 0;   // word address of vector 0
    uint16_t address = 0;       // of the access outside SRAM under way
    uint32_t return_word = 0;   // of the call under way, when the stack is outside SRAM
    uint32_t flash_address = 0; // of the read under way, when `flash` is null
    bool interrupts_on = false;
    bool transfer = false; // the T flag
    bool asleep = false;
    bool sleep_enabled = false;
    uint64_t instructions = 0; // counted by single steps only
    std::string fault;         // what stopped the core; empty: nothing

    void use(const Program& program_image);
    void reset(uint32_t start_word);
    // Runs until `until` is reached or passed by the last instruction; stops earlier at a fault.
    void run(uint64_t until);
    // Executes one instruction, or takes one interrupt.
    void step();
    uint8_t status() const;
    void set_status(uint8_t value);
    uint32_t pc() const { return static_cast<uint32_t>(at - program); }
    // Raises or withdraws a request; noticed before the next instruction.
    void request(uint8_t vector, bool active);
    void end_soon() { limit = 0; }

  private:
    void take_interrupt();
};

} // namespace tilenca::avr
