// The tile: an ATmega2560 on its board, as far as eyes, fingers and cables can reach it.
#pragma once

#include "avr/chip.h"
#include "tile/clock.h"
#include "tile/host_port.h"

#include <memory>
#include <vector>

namespace tilenca {

constexpr unsigned kSides = 4; // N E S W; the opposite of a side is two further

class Tile {
  public:
    struct DisplayChange {
        double ticks;
        uint8_t segments;
    };

    Tile(std::shared_ptr<avr::Program> program, const avr::Fuses& fuses, const Clock& clock);

    // Runs until a time in ticks; a fault stops the tile for good.
    void run_until(double end);
    // When the tile next does anything, in ticks.
    double wakes_at();

    avr::Chip& chip() { return chip_; }
    const Clock& clock() const { return clock_; }
    HostPort& host() { return host_; }

    uint8_t segments();           // bit 0 = a ... bit 6 = g, bit 7 = dp
    uint8_t leds();               // bit 0..3: debug LED of N E S W
    void colour(uint8_t duty[3]); // R G B, 0..255
    void press_button(bool pressed);
    const std::vector<DisplayChange>& display_changes() const { return display_changes_; }

    static avr::PinId receive_pin(unsigned side);
    static avr::PinId transmit_pin(unsigned side);

  private:
    bool lit(avr::PinId pin);
    void note_display();

    Clock clock_;
    avr::Chip chip_;
    HostPort host_;
    uint64_t seen_changes_ = ~uint64_t{0};
    uint8_t shown_ = 0;
    std::vector<DisplayChange> display_changes_;
};

} // namespace tilenca
