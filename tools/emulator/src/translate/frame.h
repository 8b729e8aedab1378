// What stands around the functions of a translation.
#pragma once

#include "translate/blocks.h"

#include <string>

namespace tilenca::translate {

// What a library must agree with: the places of the core's members, and this version of the text.
std::string layout();

// Before the functions of so many blocks, and after them; `functions`: the name of each block's.
std::string head_of(size_t blocks);
std::string tail_of(const avr::Program& program, const std::vector<Block>& blocks,
                    const std::vector<std::string>& functions);

} // namespace tilenca::translate
