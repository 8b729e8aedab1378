// What each instruction becomes in C++.
//
// A form is a line of C++ with gaps: %d and %r are the operands' registers, %D and %R the next higher ones,
// %c and %m the constant and its complement, %k the address or displacement. %s, %l, %p, %i, %b and %B leave
// the block where an address `a` is outside SRAM, one is beyond readable flash, a push is one to be looked
// at, `w` switches interrupts on, or the I/O register at %k goes through the bus now, read or written: the
// interpreter then executes the instruction. Registers are variables r0 to r31 and sp.
#pragma once

#include "avr/instruction.h"

#include <string>

namespace tilenca::translate {

enum class Kind : uint8_t {
    Plain,
    Skip,          // the text is the condition
    Branch,        // the text is the condition
    Jump,          // to a place that is known
    Call,          // the same, and comes back
    Dynamic,       // to the word `w` that the text works out
    DynamicCall,   // the same, and comes back
    Interpreted,   // left to the interpreter, which goes on after it
    InterpretedEnd // left to the interpreter, which goes on elsewhere
};

struct Form {
    Kind kind = Kind::Interpreted;
    const char* text = "";
    uint8_t cycles = 1;       // a skip or branch that is not taken
    bool reads_flash = false; // the lowest 64 KiB, which must be readable
};

// `special`: what I/O addresses the interpreter must see, as in avr::Cpu.
Form form_of(const avr::Instruction& instruction, const uint8_t* special);

// The text with its gaps filled; those that leave by `leave`, which follows a condition.
std::string filled(const Form& form, const avr::Instruction& instruction, const std::string& leave);

} // namespace tilenca::translate
