// The ATmega2560's interrupt vectors, in order of priority (data sheet, section 14.1).
#pragma once

#include <cstdint>

namespace tilenca::avr {

constexpr uint8_t kVectorInt0 = 1; // to INT7 = 8
constexpr uint8_t kVectorPinChange0 = 9;
constexpr uint8_t kVectorWatchdog = 12;
constexpr uint8_t kVectorTimer2CompareA = 13; // COMPB, OVF
constexpr uint8_t kVectorTimer1Capture = 16;  // COMPA, COMPB, COMPC, OVF
constexpr uint8_t kVectorTimer0CompareA = 21; // COMPB, OVF
constexpr uint8_t kVectorSpi = 24;
constexpr uint8_t kVectorUsart0Receive = 25; // UDRE, TX
constexpr uint8_t kVectorComparator = 28;
constexpr uint8_t kVectorAdc = 29;
constexpr uint8_t kVectorEeprom = 30;
constexpr uint8_t kVectorTimer3Capture = 31; // COMPA, COMPB, COMPC, OVF
constexpr uint8_t kVectorUsart1Receive = 36;
constexpr uint8_t kVectorTwi = 39;
constexpr uint8_t kVectorProgramMemory = 40;
constexpr uint8_t kVectorTimer4Capture = 41;
constexpr uint8_t kVectorTimer5Capture = 46;
constexpr uint8_t kVectorUsart2Receive = 51;
constexpr uint8_t kVectorUsart3Receive = 54;
constexpr uint8_t kVectors = 57;

} // namespace tilenca::avr
