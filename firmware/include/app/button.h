// A debounced push button.
#pragma once

#include <stdint.h>

namespace tilenca {

class Button {
  public:
    static constexpr uint8_t kDebounceMs = 20;

    // Takes the contact's present state. True once per press, when the contact has been closed for
    // kDebounceMs. It must be open for as long before the next press counts.
    bool pressed(bool closed, uint32_t now_ms) {
        if (closed == stable_) {
            changed_ms_ = now_ms;
        }
        if (now_ms - changed_ms_ < kDebounceMs) {
            return false;
        }
        stable_ = closed;
        changed_ms_ = now_ms;
        return stable_;
    }

  private:
    bool stable_ = false;
    uint32_t changed_ms_ = 0; // since when the contact differs from `stable_`
};

} // namespace tilenca
