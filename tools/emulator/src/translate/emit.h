// The text of a translation: C++ that a compiler makes a shared library of.
#pragma once

#include "translate/blocks.h"

#include <string>

namespace tilenca::translate {

// A function for each block, and the table of them. `special` as in avr::Cpu.
std::string source_of(const avr::Program& program, const std::vector<Block>& blocks, const uint8_t* special);

} // namespace tilenca::translate
