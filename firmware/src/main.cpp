// A tile: read the four sides, tick, write its frames, show its class.
#include <Arduino.h>

#include "app/appearance.h"
#include "app/button.h"
#include "app/host.h"
#include "app/line_watch.h"
#include "app/settings_store.h"
#include "app/telemetry.h"
#include "app/tile.h"
#include "app/timing.h"
#include "board/boot.h"
#include "board/chip.h"
#include "board/display.h"
#include "board/eeprom.h"
#include "board/fuses.h"
#include "board/links.h"
#include "board/pins.h"
#include "board/supply.h"
#include "board/usart.h"
#include "model/model.h"

using namespace tilenca;

namespace {

constexpr uint32_t kHostBaud = 115200;
constexpr uint8_t kLookMask = 3;     // lines, supply and stack are looked at in every fourth millisecond
constexpr uint16_t kLeastStack = 64; // fewer unused bytes are an error
constexpr Settings kDefaults = {0, TILENCA_PERIOD_MS, TILENCA_UPDATES, 255, 0};
static_assert(TILENCA_PERIOD_MS >= kMinPeriodMs && TILENCA_PERIOD_MS <= kMaxPeriodMs, "see platformio.ini");

Telemetry telemetry;

Boot boot;
Tile tile(model::kModel, kDefaults, 0);
SettingsStore<board::Eeprom> store;
Host host(kDefaults, boot);
Timing timing;
LineWatch lines;
Sentence sentence;
Button button;

void say_sentence() {
    if (!board::usart_write(board::kHostUsart, reinterpret_cast<const uint8_t*>(sentence.bytes()),
                            sentence.size())) {
        telemetry.drop();
    }
}

bool room_to_speak() {
    return board::usart_room(board::kHostUsart) >= kMaxSentence;
}

void read_sides(uint32_t now_ms) {
    for (uint8_t i = 0; i < kSides; ++i) {
        uint8_t byte;
        while (board::link_read(side_at(i), &byte)) {
            tile.receive(side_at(i), byte, now_ms);
        }
    }
}

void tick(uint32_t now_ms) {
    if (button.pressed(board::button_closed(), now_ms)) {
        tile.restart();
    }
    const uint16_t before = board::stamp();
    const bool was_busy = tile.busy();
    const bool ended = tile.tick(now_ms);
    if (was_busy) {
        timing.computed(board::stamp() - before, ended);
    }
    if (ended) {
        telemetry.period_ended(tile);
    }
}

void write_sides() {
    for (uint8_t i = 0; i < kSides; ++i) {
        const Side side = side_at(i);
        if (tile.has_frame(side) && board::link_idle(side)) {
            uint8_t wire[kMaxFrame];
            board::link_write(side, wire, tile.take_frame(side, wire));
        }
    }
}

// The host's bytes wait in their ring while there is no room for an answer, and while EEPROM is being
// written.
void obey(uint32_t now_ms) {
    const auto read = [](uint8_t* byte) { return board::usart_read(board::kHostUsart, byte); };
    while (!store.writing() && room_to_speak() && host.answer(store, read, &tile, now_ms, &sentence)) {
        say_sentence();
    }
}

void show(uint32_t now_ms) {
    static uint8_t shown = Tile::kNothing;
    static uint8_t brightness = 0;
    static uint8_t leds = 0;
    const Appearance now = appearance_of(tile, host.blinking(now_ms), now_ms);
    const bool brightness_changed = tile.settings().brightness != brightness;
    if (now.shown != shown || brightness_changed) {
        shown = now.shown;
        brightness = tile.settings().brightness;
        const Look look = look_of(tile, shown);
        board::show_segments(look.segments, brightness);
        board::show_colour(look.red, look.green, look.blue);
    }
    if (now.leds != leds || brightness_changed) {
        leds = now.leds;
        board::show_leds(leds, brightness);
    }
}

Health health() {
    Health now = {
        timing.compute_us(), timing.gap_us(), timing.awake_permille(), board::stack_unused(), {}, {}, {},
        board::supply_mv()};
    for (uint8_t i = 0; i < kSides; ++i) {
        now.overruns[i] = board::link_overruns(side_at(i));
        now.framing_errors[i] = board::link_framing_errors(side_at(i));
        now.low_ms[i] = lines.low_ms(side_at(i));
    }
    return now;
}

void look_at_board(uint32_t now_ms) {
    if ((now_ms & kLookMask) != 0) {
        return;
    }
    lines.look(board::low_lines(), now_ms);
    board::supply_watch();
    board::stack_watch();
    if (board::stack_unused() < kLeastStack) {
        telemetry.failed(Error::Stack);
    }
}

void report(uint32_t now_ms) {
    while (telemetry.next(now_ms) != Telemetry::Next::Nothing && room_to_speak()) {
        const Health now = health();
        if (now.supply_mv != 0 && now.supply_mv < kLeastSupplyMv) {
            telemetry.failed(Error::Supply, now.supply_mv);
        }
        if (telemetry.write(tile, now, now_ms, &sentence)) {
            timing.reported();
        }
        say_sentence();
    }
}

void sleep() {
    const uint16_t before = board::stamp();
    board::sleep();
    timing.slept(board::stamp() - before);
}

void load_settings() {
    Settings settings = kDefaults;
    for (uint8_t kind = kBlocks;
         kind-- != 0;) { // settings last: what is to be mended does not delay the start
        if (store.load(static_cast<Block>(kind), &settings) == SettingsStore<board::Eeprom>::Found::Damage) {
            telemetry.failed(Error::Settings);
        }
    }
    tile.apply(settings);
}

} // namespace

__attribute__((cold)) void setup() { // cold: for size, since flash is short
    const board::Fuses fuses = board::fuses();
    boot = {board::reset_cause(), board::firmware_id(), {fuses.low, fuses.high, fuses.extended, fuses.lock}};
    if (boot.reset_cause & board::kWatchdogReset) {
        telemetry.failed(Error::Watchdog, board::hung_at());
    }
    while (!board::stack_watch()) { // so that the first report is right
    }
    board::clock_begin();
    board::display_begin(); // before the links' interrupts use the same ports
    board::links_begin();
    board::usart_begin(board::kHostUsart, kHostBaud);
    board::supply_begin();
    load_settings();
    board::watchdog_begin();
    write_hello(tile, boot, &sentence);
    say_sentence();
    write_chip(tile, boot, &sentence);
    say_sentence();
}

void loop() {
    board::watchdog_feed();
    const uint32_t now_ms = board::now_ms();
    timing.turn(now_ms, board::stamp());
    read_sides(now_ms);
    tick(now_ms);
    write_sides();
    obey(now_ms);
    show(now_ms);
    look_at_board(now_ms);
    report(now_ms);
    if (!tile.busy()) {
        sleep();
    }
}
