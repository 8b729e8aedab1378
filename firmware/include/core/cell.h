// One cell of the automaton: it perceives its four neighbours, then updates its state.
#pragma once

#include <stdint.h>

#include "core/network.h"
#include "core/side.h"

namespace tilenca {

class Cell {
  public:
    // The network must outlive the cell. The cell starts as the seed.
    explicit Cell(const Network& network);

    // Sets the state that every cell starts from: 1.0 in channel 0, zero in the others. Abandons an update in
    // progress.
    void seed();

    // Begins an update from the own message and the neighbours', which are copied. Each has C values; nullptr
    // is an absent neighbour, which reads as zeros.
    void perceive(const int8_t* const (&neighbours)[kSides]);

    // Does one slice of the update. True when this completed it.
    bool update_slice();

    bool updating() const { return !forward_.done(); }

    // The message for the neighbours, C values. During an update it is still that of the last completed one.
    const int8_t* message() const { return inputs_; }

    // C stored values; half old, half new while an update is in progress.
    const int16_t* state() const { return state_; }

    uint8_t channels() const { return network_.channels(); }

    // Decides by the stored scores, which are the last `classes` channels.
    Decision decide(uint8_t classes) const;

  private:
    void tell();

    const Network& network_;
    Forward forward_;
    int16_t state_[kMaxChannels] = {};
    int8_t inputs_[kMaxInputs + 1] = {}; // of the network; the own message comes first
};

} // namespace tilenca
