// One decoded word of flash: what to do, and with what.
//
// Every instruction is a function that does its work and then calls the next one as its last act. The
// compiler turns that call into a jump (-O2 -foptimize-sibling-calls), so the six arguments stay in the
// host's registers from one instruction to the next, and each instruction has its own, well predicted,
// indirect jump.
#pragma once

#include <cstdint>

namespace tilenca::avr {

struct Cpu;
struct Instruction;

// cycle: clock cycles since power-on when this instruction starts. The flags are kept unfinished until
// someone asks:
//   carry: C as 0 or 1
//   zero:  0 when Z is set, anything else when it is clear
//   nvh:   N in bit 7, V in bit 15, H in bit 20, and in bit 31 whether S differs from N ^ V (only after a
//   write to S)
using Handler = void (*)(Cpu* cpu, const Instruction* at, uint64_t cycle, uint32_t carry, uint32_t zero,
                         uint32_t nvh);

struct Instruction {
    Handler run;
    uint8_t d;    // destination register, or a mask of one bit
    uint8_t r;    // source register, or an 8-bit constant
    uint16_t k;   // data address or displacement
    int32_t jump; // words from here to where a branch, jump or skip goes
};

// Four instructions per cache line where addresses have eight bytes.
static_assert(sizeof(Instruction) == sizeof(Handler) + 8, "no gaps");

} // namespace tilenca::avr
