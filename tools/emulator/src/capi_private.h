// What the parts of the C interface share.
#pragma once

#include "capi.h"

#include "array/array.h"

#include <string>
#include <vector>

struct tilenca_array {
    struct Eye {
        unsigned tile;
        tilenca::Probe* probe; // null: freed
    };

    tilenca::Array array;
    std::vector<std::string> faults; // what tilenca_tile_fault gives out must live on
    std::vector<uint8_t> snapshot;
    std::string function;
    std::vector<Eye> eyes;
};

namespace tilenca::capi {

// Sets what tilenca_last_error says; returns -1.
int fail(const std::string& message);
bool find_pin(char port, unsigned bit, avr::PinId* pin);

} // namespace tilenca::capi
