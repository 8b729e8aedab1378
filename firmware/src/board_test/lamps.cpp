#include "board_test/lamps.h"

#include "board/display.h"
#include "board/pins.h"
#include "board_test/say.h"
#include "core/side.h"

namespace tilenca {

namespace {

// The display while LEDs and colours are tested.
constexpr uint8_t kGlyphL = 0x38;
constexpr uint8_t kGlyphC = 0x39;

} // namespace

uint8_t lamps_of(Step step) {
    switch (step) {
    case Step::Segments:
        return 8;
    case Step::Leds:
        return kSides;
    case Step::Colours:
        return 3;
    case Step::Sides:
        break;
    }
    return 0;
}

void light(Step step, uint8_t lamp) {
    board::show_leds(step == Step::Leds ? static_cast<uint8_t>(1 << lamp) : 0);
    const bool colours = step == Step::Colours;
    board::show_colour(colours && lamp == 0 ? kDuty : 0, colours && lamp == 1 ? kDuty : 0,
                       colours && lamp == 2 ? kDuty : 0);
    switch (step) {
    case Step::Segments:
        board::show_segments(static_cast<uint8_t>(1 << lamp));
        say(PSTR("display: only segment "));
        if (lamp == 7) {
            say(PSTR("dp"));
        } else {
            say(static_cast<char>('a' + lamp));
        }
        say(' ');
        say(board::kSegments[lamp]);
        say_end();
        break;
    case Step::Leds:
        board::show_segments(kGlyphL);
        say(PSTR("LEDs: only LED "));
        say_number(lamp + 1);
        say(' ');
        say(board::kDebugLeds[lamp]);
        say_end();
        break;
    case Step::Colours:
        board::show_segments(kGlyphC);
        say(PSTR("colours: only "));
        say(lamp == 0 ? PSTR("red ") : lamp == 1 ? PSTR("green ") : PSTR("blue "));
        say(lamp == 0 ? board::kRed : lamp == 1 ? board::kGreen : board::kBlue);
        say_end();
        break;
    case Step::Sides:
        break;
    }
}

} // namespace tilenca
