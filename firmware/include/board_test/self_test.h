// The steps that a board passes by itself: supply, fuses, bootloader, EEPROM, LEDs, pins, rates, clock.
#pragma once

#include <stdint.h>

#include "board_test/side_check.h"

namespace tilenca {

class SelfTest {
  public:
    // `checks` are those of the four sides.
    explicit SelfTest(const SideCheck (&checks)[kSides]) : checks_(checks) {}

    // Begins with the first step.
    void begin(uint32_t now_ms);

    bool running() const { return part_ != Part::Done; }

    // Goes on. Call it in every turn of the main loop.
    void turn(uint32_t now_ms);

  private:
    enum class Part : uint8_t { Supply, Fuses, Bootloader, Eeprom, Leds, Pins, Clock, Rates, Done };

    void next(uint32_t now_ms);
    void failed() { ++failed_; }
    void check_supply();
    void check_leds();
    bool waits_for_clock() const;
    void check_clock();
    void say_rates();
    void say_end_of_all() const;

    const SideCheck (&checks_)[kSides];
    Part part_ = Part::Done;
    uint32_t since_ms_ = 0;
    uint8_t failed_ = 0;
};

} // namespace tilenca
