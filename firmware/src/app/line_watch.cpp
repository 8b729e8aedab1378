#include "app/line_watch.h"

namespace tilenca {

void LineWatch::look(uint8_t low, uint32_t now_ms) {
    always_low_ &= low;
    const uint8_t passed_ms = static_cast<uint8_t>(static_cast<uint8_t>(now_ms) - began_ms_);
    if (passed_ms < kWindowMs) {
        return;
    }
    began_ms_ = static_cast<uint8_t>(now_ms);
    for (uint8_t i = 0, mask = 1; i < kSides; ++i, mask <<= 1) {
        uint8_t& run_ms = run_ms_[i];
        if (!(always_low_ & mask)) {
            run_ms = 0;
        } else if (run_ms == kLeastLowMs) {
            low_ms_[i] += passed_ms;
        } else if (passed_ms < kLeastLowMs - run_ms) {
            run_ms += passed_ms;
        } else {
            low_ms_[i] += run_ms + passed_ms;
            run_ms = kLeastLowMs;
        }
    }
    always_low_ = kAllSides;
}

} // namespace tilenca
