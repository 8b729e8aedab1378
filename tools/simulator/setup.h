// The checks of what callers of the C interface give.
#pragma once

#include "tilenca/simulator.h"

namespace tilenca {

// Throw c_api::Refusal where a number or an index is out of range, or an array is missing.
void check_model(const tilenca_model& model);
void check_setup(const tilenca_setup& setup);

} // namespace tilenca
