// What the parts of the C interface share. All of it throws; the guards at the entry points catch.
#pragma once

#include "array/array.h"
#include "c_api/guard.h"
#include "tilenca/emulator.h"

#include <deque>
#include <string>
#include <vector>

struct tilenca_array {
    struct Eye {
        unsigned tile;
        tilenca::Probe* probe; // null: freed
    };

    tilenca::Array array;
    std::deque<std::string> faults; // what tilenca_tile_fault gives out must live on
    std::vector<uint8_t> snapshot;
    std::string function, translated;
    std::vector<Eye> eyes;
};

namespace tilenca::c_api {

Array& array_of(tilenca_array* handle);
Tile& tile_of(tilenca_array* handle, unsigned tile);
Array::End end_of(tilenca_array* handle, unsigned tile, unsigned side);
avr::PinId pin_of(char port, unsigned bit);
Clock clock_of(double ppm, double switch_on_s);

} // namespace tilenca::c_api
