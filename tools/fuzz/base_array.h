// A small array that uses every part of the chip: snapshots of it are what the fuzzer begins with.
#pragma once

#include "array/array.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tilenca {
namespace fuzz {

// A program, made by hand, that switches every peripheral on and then sends on all USARTs.
Image base_image();

// Two tiles with that program and three cables, of which one harms what it carries; the second tile is
// switched on a little later. `variant` decides how far it has run, and what was done to it.
std::unique_ptr<Array> base_array(unsigned variant);
constexpr unsigned kVariants = 4;

} // namespace fuzz
} // namespace tilenca
