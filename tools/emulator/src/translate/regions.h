// Which blocks share one function: those of a loop, so that registers stay in the host's from one round to
// the next.
#pragma once

#include "translate/blocks.h"

#include <cstddef>

namespace tilenca::translate {

// The numbers of the blocks of each function, which lie in flash in that order; each block is in one of them.
std::vector<std::vector<size_t>> regions_of(const avr::Program& program, const std::vector<Block>& blocks,
                                            const uint8_t* special);

} // namespace tilenca::translate
