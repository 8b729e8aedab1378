#include "cells.h"

#include <string.h>

#include "copy.h"
#include "core/network.h"
#include "core/side.h"

namespace tilenca {

Cells::Cells(const PackedNetwork& network, uint8_t classes, int count, int16_t* states)
    : network_(network), classes_(classes), stride_(kNeighbourhood * network.channels),
      inputs_(count * stride_), states_(states) {
    for (int cell = 0; cell < count; ++cell) {
        update_message(cell);
    }
}

void Cells::apply(const Tick& tick, const Links& links, Display& display) {
    for (int32_t cell : tick.switched_off) {
        display.show(cell, kDark);
    }
    for (int32_t cell : tick.taken_away) {
        display.count(cell, false);
    }
    for (int32_t cell : tick.put_down) {
        display.count(cell, true);
    }
    for (int32_t cell : tick.switched_on) {
        switch_on(cell);
    }
    for (const Event& arrival : tick.deliveries) {
        deliver(arrival, links);
    }
    update(tick.updates, display);
}

void Cells::update_message(int cell) {
    for (int c = 0; c < network_.channels; ++c) {
        inputs(cell)[c] = message_of(state(cell)[c]);
    }
}

void Cells::switch_on(int cell) {
    memset(state(cell), 0, network_.channels * sizeof(int16_t));
    memset(inputs(cell), 0, stride_);
    state(cell)[0] = kSeedState;
    update_message(cell);
}

void Cells::deliver(const Event& arrival, const Links& links) {
    for (int side = 0; side < kSides; ++side) {
        if (arrival.sides >> side & 1) {
            const uint8_t theirs = index_of(opposite(side_at(static_cast<uint8_t>(side))));
            int8_t* received = inputs(links.neighbour(arrival.cell, side)) + (1 + theirs) * network_.channels;
            copy(received, inputs(arrival.cell), network_.channels);
        }
    }
}

void Cells::update(const std::vector<Event>& events, Display& display) {
    batch_.clear();
    for (const Event& event : events) {
        batch_.push_back({inputs(event.cell), state(event.cell), static_cast<uint8_t>(event.sides)});
    }
    update_cells(network_, batch_.data(), batch_.size());
    for (const Event& event : events) {
        const int16_t* scores = state(event.cell) + network_.channels - classes_;
        update_message(event.cell);
        display.show(event.cell, static_cast<int8_t>(best_class(scores, classes_)));
    }
    updates_ += events.size();
}

} // namespace tilenca
