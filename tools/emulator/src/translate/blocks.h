// Which runs of instructions are worth translating: where they begin, and where they end.
#pragma once

#include "avr/program.h"

#include <cstdint>
#include <vector>

namespace tilenca::translate {

// Instructions that are executed one after the other; a branch that is taken leaves them.
struct Block {
    std::vector<uint32_t> words; // of flash, at which they begin
    uint64_t executed = 0;       // instructions, all times together
};

// The word after an instruction.
uint32_t word_after(const avr::Program& program, uint32_t word);

// The blocks that cover nearly all of what a program executed, those first that were executed most.
// `executed`: how often, by word of flash; `special`: what I/O addresses the interpreter must see, as in
// avr::Cpu.
std::vector<Block> hot_blocks(const avr::Program& program, const std::vector<uint64_t>& executed,
                              const uint8_t* special);

} // namespace tilenca::translate
