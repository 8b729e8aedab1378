#include "board/supply.h"

#include <avr/io.h>

namespace tilenca {
namespace board {

namespace {

constexpr uint32_t kBandgapMv = 1100;
constexpr uint16_t kFullScale = 1024;
constexpr uint8_t kConversions = 64; // of at most 1023: their sum has 16 bits
constexpr uint8_t kSkipped = 2;      // the bandgap's buffer has to settle (data sheet, ADC input channels)

uint16_t sum = 0;
uint16_t last_sum = 0;
uint8_t left = kConversions + kSkipped;

} // namespace

void supply_begin() {
    ADMUX = 1 << REFS0 | 0x1E; // AVCC is the reference, the bandgap the input
    ADCSRB = 0;
    ADCSRA = 1 << ADEN | 1 << ADPS2 | 1 << ADPS1 | 1 << ADPS0 | 1 << ADSC;
}

void supply_watch() {
    if (ADCSRA & 1 << ADSC) {
        return;
    }
    --left;
    if (left < kConversions) {
        sum += ADC;
    }
    if (left == 0) {
        last_sum = sum;
        sum = 0;
        left = kConversions;
    }
    ADCSRA |= 1 << ADSC;
}

uint16_t supply_mv() {
    return last_sum == 0 ? 0 : static_cast<uint16_t>(kBandgapMv * kFullScale * kConversions / last_sum);
}

} // namespace board
} // namespace tilenca
