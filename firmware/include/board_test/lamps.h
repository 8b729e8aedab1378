// The steps of the board test, and the lamps that some of them light one by one.
#pragma once

#include <stdint.h>

namespace tilenca {

enum class Step : uint8_t { Segments, Leds, Colours, Sides };
constexpr uint8_t kSteps = 4;

constexpr uint8_t kDuty = 60; // bright enough to see, and to look at

// How many lamps a step lights in turn; 0: none.
uint8_t lamps_of(Step step);

// Lights one of them alone, and says which.
void light(Step step, uint8_t lamp);

} // namespace tilenca
