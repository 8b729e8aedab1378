#include "board_test/pin_check.h"

#include <avr/io.h>
#include <string.h>

#include "board/display.h"
#include "board/gpio.h"
#include "board_test/say.h"

namespace tilenca {

namespace {

// Those that are driven in turn, and then the link LEDs, which avr/clock.S drives.
constexpr uint8_t kDriven = 11;
constexpr uint8_t kPins = 15;

board::Pin pin_at(uint8_t index) {
    if (index < 8) {
        return board::kSegments[index];
    }
    return index == 8    ? board::kRed
           : index == 9  ? board::kGreen
           : index == 10 ? board::kBlue
                         : board::kDebugLeds[index - kDriven];
}

} // namespace

void PinCheck::begin() {
    board::show_leds(0);
    board::show_segments(0, 0);
    TCCR1A = 1 << WGM11; // no timer drives a pin
    TCCR2A = 1 << WGM20;
    TCCR3A = 1 << WGM30;
    failed_ = driven_ = 0;
    memset(highs_, 0, sizeof highs_);
    drive(false);
}

void PinCheck::drive(bool high) {
    high_ = high;
    turns_ = 0;
    for (uint8_t i = 0; i < kPins; ++i) {
        const board::Pin pin = pin_at(i);
        board::set(pin, false);
        board::ddr_of(pin) &= static_cast<uint8_t>(~board::mask_of(pin));
    }
    board::make_output(pin_at(driven_));
    board::set(pin_at(driven_), high);
}

bool PinCheck::turn() {
    if (++turns_ <= kSettleMs) {
        return false;
    }
    for (uint8_t i = 0; i < kPins; ++i) {
        highs_[high_][i] += board::is_high(pin_at(i));
    }
    if (turns_ < kSettleMs + kLooks) {
        return false;
    }
    if (!high_) {
        drive(true);
        return false;
    }
    judge();
    if (++driven_ < kDriven) {
        drive(false);
        return false;
    }
    board::display_begin();
    return true;
}

void PinCheck::judge() {
    for (uint8_t i = 0; i < kPins; ++i) {
        const bool when_low = highs_[0][i] == kLooks;
        const bool joined = i != driven_ && highs_[0][i] == 0 && highs_[1][i] == kLooks;
        const bool stuck = i != driven_ && when_low && highs_[1][i] == kLooks && driven_ == (i == 0);
        if (joined) {
            say(PSTR("pins: FAIL, "));
            say(pin_at(driven_));
            say(PSTR(" and "));
            say(pin_at(i));
            say(PSTR(" are joined: look for a bridge of solder"));
            say_end();
        } else if (stuck) {
            say(PSTR("pins: FAIL, "));
            say(pin_at(i));
            say(PSTR(" stays high: a short to the supply"));
            say_end();
        }
        failed_ += joined || stuck;
    }
    memset(highs_, 0, sizeof highs_);
}

} // namespace tilenca
