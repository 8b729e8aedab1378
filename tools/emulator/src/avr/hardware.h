// How far a chip and its board differ from ideal ones.
#pragma once

#include "avr/archive.h"

#include <cstdint>

namespace tilenca::avr {

struct Hardware {
    uint64_t seed = 0;            // of what is left to chance here
    bool floating_inputs = false; // they read noise; otherwise high
    bool sram_noise = false;      // at power-on; otherwise zeros
    bool start_up = false;        // a reset takes the time that the fuses say; otherwise none
    double watchdog_error = 0;    // its clock is off by a share of at most so much (0..1)

    void state(Archive& archive) {
        archive(seed, floating_inputs, sram_noise, start_up, watchdog_error);
        archive.require_range(watchdog_error, 0.0, 0.5, "its watchdog is none");
    }
};

} // namespace tilenca::avr
