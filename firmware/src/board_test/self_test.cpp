#include "board_test/self_test.h"

#include <avr/io.h>
#include <avr/pgmspace.h>

#include "app/telemetry.h" // kLeastSupplyMv
#include "board/chip.h"
#include "board/display.h"
#include "board/gpio.h"
#include "board/links.h"
#include "board/supply.h"
#include "board_test/chip_check.h"
#include "board_test/pin_check.h"
#include "board_test/say.h"

namespace tilenca {

namespace {

constexpr uint16_t kSupplyMs = 200; // after these the supply is known
constexpr uint16_t kRatesMs = 1200; // two windows of the sides
constexpr uint16_t kClockMs = 4000; // after these, every neighbour's clock is known

// A link LED between its resistor and the pin's pull-up has some 1.8 V of 5.
constexpr uint8_t kFirstLedChannel = 8; // ADC8 is PK0
constexpr uint16_t kLeastLed = 150, kMostLed = 900;

PinCheck pins;

// What a pin of port K converts to with its pull-up.
uint16_t convert_pulled_up(uint8_t bit) {
    const board::Pin pin = {'K', bit};
    TIMSK4 = 0; // its interrupt would turn the pull-up off
    board::ddr_of(pin) &= static_cast<uint8_t>(~board::mask_of(pin));
    board::set(pin, true);
    ADCSRB = 1 << MUX5;
    ADMUX = static_cast<uint8_t>(1 << REFS0 | bit);
    uint16_t found = 0;
    for (uint8_t i = 0; i < 3; ++i) { // the first ones may have begun before, or not have settled
        while (ADCSRA & 1 << ADSC) {
        }
        ADCSRA |= 1 << ADSC;
        while (ADCSRA & 1 << ADSC) {
        }
        found = ADC;
    }
    board::set(pin, false);
    board::make_output(pin);
    TIMSK4 = 1 << TOIE4;
    return found;
}

} // namespace

void SelfTest::begin(uint32_t now_ms) {
    failed_ = 0;
    part_ = Part::Supply;
    since_ms_ = now_ms;
}

void SelfTest::next(uint32_t now_ms) {
    part_ = static_cast<Part>(static_cast<uint8_t>(part_) + 1);
    since_ms_ = now_ms;
    switch (part_) {
    case Part::Pins:
        pins.begin();
        break;
    case Part::Rates:
        board::link_begin(Side::North, board::kRowBaud);
        board::link_begin(Side::East, board::kLinkBaud);
        board::link_begin(Side::West, board::kLinkBaud);
        break;
    case Part::Done:
        say_end_of_all();
        break;
    default:
        break;
    }
}

void SelfTest::turn(uint32_t now_ms) {
    board::supply_watch();
    switch (part_) {
    case Part::Supply:
        if (board::supply_mv() == 0 && now_ms - since_ms_ < kSupplyMs) {
            return;
        }
        check_supply();
        break;
    case Part::Fuses:
        failed_ += !check_fuses();
        break;
    case Part::Bootloader:
        failed_ += !check_bootloader();
        break;
    case Part::Eeprom:
        failed_ += !check_eeprom();
        break;
    case Part::Leds:
        check_leds();
        break;
    case Part::Pins:
        if (!pins.turn()) {
            return;
        }
        failed_ += pins.failed() != 0;
        if (pins.failed() == 0) {
            say_pass(PSTR("pins"));
            say_end();
        }
        break;
    case Part::Rates:
        if (now_ms - since_ms_ < kRatesMs) {
            return;
        }
        say_rates();
        break;
    case Part::Clock:
        if (waits_for_clock() && now_ms - since_ms_ < kClockMs) {
            return;
        }
        check_clock();
        break;
    case Part::Done:
        return;
    }
    next(now_ms);
}

void SelfTest::check_supply() {
    const uint16_t mv = board::supply_mv();
    if (mv >= kLeastSupplyMv) {
        say_pass(PSTR("supply"));
        say(PSTR(", "));
        say_number(mv);
        say(PSTR(" mV"));
    } else {
        failed();
        say_fail(PSTR("supply"));
        say_number(mv);
        say(PSTR(" mV, and 16 MHz need 4500: the regulator, jumper J3, a plug, or a weak USB port"));
    }
    say_end();
}

void SelfTest::check_leds() {
    bool good = true;
    for (uint8_t i = 0; i < kSides; ++i) {
        const uint16_t found = convert_pulled_up(i);
        if (found >= kLeastLed && found <= kMostLed) {
            continue;
        }
        good = false;
        say_fail(PSTR("link LEDs"));
        say(PSTR("LED "));
        say_number(i + 1);
        say(found > kMostLed ? PSTR(" is missing, or the wrong way round: ") : PSTR(" has a short: "));
        say(board::kDebugLeds[i]);
        say_end();
    }
    failed_ += !good;
    if (good) {
        say_pass(PSTR("link LEDs"));
        say_end();
    }
    board::supply_begin();
}

void SelfTest::say_rates() {
    for (uint8_t i = 0; i < kSides; ++i) {
        const Side side = side_at(i);
        if (side == Side::South) {
            continue;
        }
        const bool good = checks_[i].verdict() == Verdict::LoopBack;
        say(PSTR("rate "));
        say(kSideLetters[i]);
        say(good ? PSTR(": pass, loop-back at ") : PSTR(": not tested, no loop-back plug at "));
        say(board::baud_of(side) == board::kRowBaud ? PSTR("38400") : PSTR("125000"));
        say(PSTR(" baud"));
        say_end();
        board::link_begin(side, board::baud_of(side));
    }
}

bool SelfTest::waits_for_clock() const {
    bool waits = false;
    for (const SideCheck& check : checks_) {
        waits |= check.verdict() == Verdict::Waiting ||
                 (check.verdict() == Verdict::Neighbour && !check.knows_clock());
    }
    return waits;
}

void SelfTest::check_clock() {
    bool any = false, good = true;
    for (uint8_t i = 0; i < kSides; ++i) {
        if (!checks_[i].knows_clock()) {
            continue;
        }
        any = true;
        const int16_t slower = checks_[i].slower_permille();
        const uint16_t apart = static_cast<uint16_t>(slower < 0 ? -slower : slower);
        const bool well = apart <= SideCheck::kMostPermille;
        good &= well;
        well ? say_pass(PSTR("clock")) : say_fail(PSTR("clock"));
        if (well) {
            say(PSTR(", "));
        }
        say(PSTR("the neighbour on "));
        say(kSideLetters[i]);
        say(PSTR(" is "));
        say_number(apart);
        say(slower < 0 ? PSTR(" permille faster") : PSTR(" permille slower"));
        if (!well) {
            say(PSTR(": this resonator or that one; try another neighbour"));
        }
        say_end();
    }
    failed_ += !good;
    if (!any) {
        say(PSTR("clock: not tested, no tile with this firmware beside it"));
        say_end();
    }
}

void SelfTest::say_end_of_all() const {
    say(PSTR("self-test: "));
    if (failed_ == 0) {
        say(PSTR("pass"));
    } else {
        say(PSTR("FAIL, "));
        say_number(failed_);
        say(PSTR(" of its steps"));
    }
    say_end();
}

} // namespace tilenca
