// What `tilenca export` renders: a network, its classes, and the look of each class.
#pragma once

#include <stdint.h>

#include "core/flash.h"
#include "core/network.h"

namespace tilenca {

// How a tile shows a class. Segments: bit 0 = a ... bit 6 = g, bit 7 = dp; colours: duty of 255.
struct Look {
    char label;
    uint8_t segments;
    uint8_t red;
    uint8_t green;
    uint8_t blue;
};

struct Model {
    uint16_t id; // equal networks have equal ids
    uint8_t classes;
    Network network;
    FlashView<Look> looks; // one per class
    uint8_t directions;    // kSides: the channels before the classes say where a tile is missing; 0: none do
};

} // namespace tilenca
