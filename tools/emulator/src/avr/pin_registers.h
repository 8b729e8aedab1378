// Addresses of the registers of external and pin-change interrupts.
#pragma once

#include <cstdint>

namespace tilenca::avr {

constexpr uint16_t kPcifr = 0x3B, kEifr = 0x3C, kEimsk = 0x3D, kPcicr = 0x68, kEicra = 0x69, kEicrb = 0x6A;
constexpr uint16_t kPcmsk0 = 0x6B; // PCMSK1 and PCMSK2 follow

} // namespace tilenca::avr
