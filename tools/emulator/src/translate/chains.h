// Instructions that add, subtract or compare numbers of several bytes, a byte each: ADD and ADC, CP and CPC.
#pragma once

#include "translate/registers.h"

#include <vector>

namespace tilenca::translate {

// A chain of such instructions; empty: none begins there.
struct Chain {
    unsigned count = 0;          // of instructions, each of one word and one cycle
    unsigned first = 0;          // register of the number that is changed; the others follow it
    std::string operand, effect; // the other number; what is done
    bool is_stored = false;      // not only compared
    // In C++, where the registers are joined.
    std::string text() const;
};

// `instructions`: one after the other, at the beginning of which a chain is looked for.
Chain chain_of(const std::vector<avr::Instruction>& instructions);

} // namespace tilenca::translate
