// Is the board in order? Each step lights something or tests the sides. The button goes to the next step, a
// letter from the host to any. docs/BOARD_TEST.md says what to look for.
#include <Arduino.h>

#include "app/button.h"
#include "board/boot.h"
#include "board/chip.h"
#include "board/display.h"
#include "board/gpio.h"
#include "board/links.h"
#include "board/pins.h"
#include "board/supply.h"
#include "board/usart.h"
#include "board_test/lamps.h"
#include "board_test/say.h"
#include "board_test/self_test.h"
#include "board_test/side_check.h"

using namespace tilenca;

namespace {

constexpr uint32_t kHostBaud = 115200;
constexpr uint16_t kLampMs = 500;
constexpr char kLetters[kSteps + 1] = "dlcs";

// For the display: how many sides are in order.
constexpr uint8_t kDigits[kSides + 1] = {0x3F, 0x06, 0x5B, 0x4F, 0x66};

Step step = Step::Segments;
uint32_t lamp_since_ms = 0;
uint8_t lamp = 0; // which of a step's lamps is lit
Button button;
SideCheck checks[kSides] = {SideCheck(Side::North), SideCheck(Side::East), SideCheck(Side::South),
                            SideCheck(Side::West)};
SelfTest self_test(checks);

PGM_P text_of(Verdict verdict) {
    switch (verdict) {
    case Verdict::Waiting:
        return PSTR("wait");
    case Verdict::Nothing:
        return PSTR("FAIL, heard nothing: no plug, no tile, or a broken line to ");
    case Verdict::Low:
        return PSTR("FAIL, always low: a short, or a broken line to ");
    case Verdict::LoopBack:
        return PSTR("pass, loop-back");
    case Verdict::Neighbour:
        return PSTR("pass, a tile that hears this one, from its side ");
    case Verdict::OneWay:
        return PSTR("FAIL, a tile that does not hear this one: a broken line from ");
    case Verdict::Unreliable:
        return PSTR("FAIL, packets lost: ");
    }
    return PSTR("");
}

void say_side(uint8_t i) {
    const SideCheck& check = checks[i];
    say(PSTR("side "));
    say(kSideLetters[i]);
    say(PSTR(": "));
    say(text_of(check.verdict()));
    switch (check.verdict()) {
    case Verdict::Nothing:
    case Verdict::Low:
        say(board::kSideRx[i]);
        break;
    case Verdict::OneWay:
        say(board::kSideTx[i]);
        break;
    case Verdict::Neighbour:
        say(kSideLetters[index_of(opposite(side_at(i)))]);
        break;
    case Verdict::Unreliable:
        say_number(check.lost());
        break;
    case Verdict::Waiting:
    case Verdict::LoopBack:
        break;
    }
    say_end();
}

void say_help() {
    say(PSTR("board test: press the button for the next step, or send d display, l LEDs, c colours, s sides, "
             "b button, t self-test, w watchdog, ? this"));
    say_end();
}

void say_button() {
    say(board::button_closed() ? PSTR("button: closed") : PSTR("button: open"));
    say_end();
}

void show_sides() {
    uint8_t good = 0;
    uint8_t leds = 0;
    bool failed = false;
    for (uint8_t i = 0; i < kSides; ++i) {
        const Verdict verdict = checks[i].verdict();
        leds |= is_good(verdict) << i;
        good += is_good(verdict);
        failed |= !is_good(verdict) && verdict != Verdict::Waiting;
    }
    board::show_leds(leds);
    board::show_segments(kDigits[good]);
    board::show_colour(failed ? kDuty : 0, good == kSides ? kDuty : 0, 0);
}

void begin_step(Step which, uint32_t now_ms) {
    step = which;
    lamp = 0;
    lamp_since_ms = now_ms;
    light(step, lamp);
    if (step == Step::Sides) {
        show_sides();
        for (uint8_t i = 0; i < kSides; ++i) {
            say_side(i);
        }
    }
}

void go_on(uint32_t now_ms) {
    if (self_test.running()) {
        self_test.turn(now_ms);
        if (!self_test.running()) {
            begin_step(step, now_ms); // its lamps again
        }
        return;
    }
    if (step != Step::Sides && now_ms - lamp_since_ms >= kLampMs) {
        lamp_since_ms += kLampMs;
        lamp = static_cast<uint8_t>((lamp + 1) % lamps_of(step));
        light(step, lamp);
    }
}

// The watchdog starts the program again, and setup() says that it has.
void hang() {
    say(PSTR("watchdog: hangs now; if nothing follows within a second, it does not work"));
    say_end();
    board::watchdog_begin();
    for (;;) {
    }
}

void obey(char letter, uint32_t now_ms) {
    for (uint8_t i = 0; i < kSteps; ++i) {
        if (letter == kLetters[i]) {
            begin_step(static_cast<Step>(i), now_ms);
        }
    }
    if (letter == 't' && !self_test.running()) {
        self_test.begin(now_ms);
    }
    if (letter == 'w') {
        hang();
    }
    if (letter == 'b') {
        say_button();
    }
    if (letter == '?') {
        say_help();
    }
}

void listen(uint32_t now_ms) {
    for (uint8_t byte; board::usart_read(board::kHostUsart, &byte);) {
        obey(static_cast<char>(byte), now_ms);
    }
    if (button.pressed(board::button_closed(), now_ms)) {
        say(PSTR("button: pass, pressed"));
        say_end();
        begin_step(static_cast<Step>((static_cast<uint8_t>(step) + 1) % kSteps), now_ms);
    }
}

// The sides are tested in every step, since a neighbour may be in another one.
void check_sides(uint32_t now_ms) {
    static uint32_t sent_ms = 0;
    static uint32_t judged_ms = 0;
    const bool send = now_ms - sent_ms >= SideCheck::kPacketMs;
    const bool judge = now_ms - judged_ms >= SideCheck::kWindowMs;
    sent_ms += send ? SideCheck::kPacketMs : 0;
    judged_ms += judge ? SideCheck::kWindowMs : 0;
    for (uint8_t i = 0; i < kSides; ++i) {
        const Side side = side_at(i);
        for (uint8_t byte; board::link_read(side, &byte);) {
            checks[i].receive(byte, now_ms);
        }
        checks[i].look(board::is_high(board::kSideRx[i]));
        if (send && board::link_idle(side)) {
            uint8_t packet[SideCheck::kPacketSize];
            checks[i].write_packet(packet);
            board::link_write(side, packet, sizeof packet);
        }
        if (judge && checks[i].judge() && step == Step::Sides && !self_test.running()) {
            say_side(i);
            show_sides();
        }
    }
}

} // namespace

void setup() {
    board::clock_begin();
    board::display_begin(); // before the links' interrupts use the same ports
    board::links_begin();
    board::usart_begin(board::kHostUsart, kHostBaud);
    board::supply_begin();
    if (board::reset_cause() & board::kWatchdogReset) {
        say(PSTR("watchdog: pass, it has started the program again"));
        say_end();
    }
    say_help();
    if (board::button_closed()) {
        say(PSTR("button: FAIL, closed without being pressed, unless somebody does "));
        say(board::kButton);
        say_end();
    }
    begin_step(Step::Segments, board::now_ms());
}

void loop() {
    const uint32_t now_ms = board::now_ms();
    listen(now_ms);
    check_sides(now_ms);
    go_on(now_ms);
    board::sleep();
}
