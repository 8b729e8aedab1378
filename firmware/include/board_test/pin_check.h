// Finds pins of the display that are joined, or high when nobody drives them.
//
// One pin after the other is low and then high, while all others are inputs. A LED and its resistor hold an
// input low; one that follows another pin is joined to it.
#pragma once

#include <stdint.h>

#include "board/pins.h"

namespace tilenca {

class PinCheck {
  public:
    void begin();

    // Call it every millisecond. True when all pins are done; the display's pins are outputs again then.
    bool turn();

    // How many faults it has named.
    uint8_t failed() const { return failed_; }

  private:
    static constexpr uint8_t kSettleMs = 4;
    static constexpr uint8_t kLooks = 12; // noise on a floating input is not the same so often

    void drive(bool high);
    void judge();

    uint8_t driven_ = 0; // which pin
    bool high_ = false;
    uint8_t turns_ = 0;
    uint8_t failed_ = 0;
    uint8_t highs_[2][15] = {}; // how often an input was high while the driven pin was low, and high
};

} // namespace tilenca
