// Where a timer's registers lie, from TCCRnA on.
#pragma once

namespace tilenca::avr {

// Of a wide timer: TCCRnC, then pairs of bytes.
constexpr unsigned kWideForce = 2, kWideCount = 4, kWideCapture = 6, kWideCompare = 8, kWideEnd = 14;
constexpr unsigned kNarrowCount = 2, kNarrowCompare = 3, kNarrowEnd = 5;

} // namespace tilenca::avr
