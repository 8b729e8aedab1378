// A push button without its bouncing.
#pragma once

#include <stdint.h>

namespace tilenca {

class Button {
  public:
    static constexpr uint8_t kSettleMs = 20;

    // Takes the contact as it is now. True once per press, when it has been closed for kSettleMs; it must
    // have been open as long before it counts again.
    bool pressed(bool closed, uint32_t now_ms) {
        if (closed == settled_) {
            changed_ms_ = now_ms;
        }
        if (now_ms - changed_ms_ < kSettleMs) {
            return false;
        }
        settled_ = closed;
        changed_ms_ = now_ms;
        return settled_;
    }

  private:
    bool settled_ = false;
    uint32_t changed_ms_ = 0; // since when the contact differs from `settled_`
};

} // namespace tilenca
