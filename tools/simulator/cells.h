// The states of a group of cells, and what each holds of its neighbours' messages.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include <vector>

#include "display.h"
#include "links.h"
#include "schedule.h"
#include "update.h"

namespace tilenca {

class Cells {
  public:
    // `states` [count][C] stays the caller's and is changed in place.
    Cells(const PackedNetwork& network, uint8_t classes, int count, int16_t* states);

    // Applies a tick.
    void apply(const Tick& tick, const Links& links, Display& display);

    // How many updates were computed in all.
    uint64_t updates() const { return updates_; }

  private:
    int8_t* inputs(int cell) { return &inputs_[cell * stride_]; }
    int16_t* state(int cell) { return states_ + static_cast<size_t>(cell) * network_.channels; }
    void update_message(int cell);
    void switch_on(int cell);
    void deliver(const Event& arrival, const Links& links);
    void update(const std::vector<Event>& events, Display& display);

    const PackedNetwork& network_;
    uint8_t classes_;
    size_t stride_;
    std::vector<int8_t> inputs_; // [cell][own, N, E, S, W][C], as the network reads them
    int16_t* states_;
    uint64_t updates_ = 0;
    std::vector<CellUpdate> batch_;
};

} // namespace tilenca
