// A tile: read the four sides, tick, write what it says, show it.
#include <Arduino.h>

#include "app/appearance.h"
#include "app/button.h"
#include "app/host.h"
#include "app/telemetry.h"
#include "app/tile.h"
#include "app/timing.h"
#include "board/boot.h"
#include "board/chip.h"
#include "board/eeprom.h"
#include "board/face.h"
#include "board/links.h"
#include "board/pins.h"
#include "board/usart.h"
#include "model/model.h"

using namespace tilenca;

namespace {

constexpr uint32_t kHostBaud = 115200;
constexpr uint16_t kLeastStack = 64; // less of it unused is an error
constexpr Settings kDefaults = {0, TILENCA_PERIOD_MS, TILENCA_UPDATES, 255};
static_assert(TILENCA_PERIOD_MS >= kMinPeriodMs && TILENCA_PERIOD_MS <= kMaxPeriodMs, "see platformio.ini");

Telemetry telemetry;

Settings read_settings() {
    uint8_t first[kSettingsSize], second[kSettingsSize];
    while (board::eeprom_writing()) { // since before a reset
    }
    board::eeprom_read(board::Kept::First, first, sizeof first);
    board::eeprom_read(board::Kept::Second, second, sizeof second);
    Settings settings = kDefaults;
    if (parse_settings(first, &settings)) {
        return settings;
    }
    if (parse_settings(second, &settings)) {
        // The next change writes the second ones first: the first must be whole by then.
        board::eeprom_write(second, sizeof second);
        while (board::eeprom_writing()) {
        }
    } else if (!is_blank(first)) {
        telemetry.failed(Error::Settings);
    }
    return settings;
}

Boot boot;
Tile tile(model::kModel, read_settings(), 0);
Host host(kDefaults, boot);
Timing timing;
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

// What the host says waits in its ring while there is no room for the answer, or EEPROM is being written.
void obey(uint32_t now_ms) {
    enum class Writing : uint8_t { Nothing, New, Old };
    static Writing writing = Writing::Nothing;
    uint8_t byte;
    if (writing != Writing::Nothing && !board::eeprom_writing() && room_to_speak()) {
        const bool is_new = writing == Writing::New;
        writing = Writing::Nothing;
        if (is_new) {
            uint8_t first[kSettingsSize], second[kSettingsSize];
            board::eeprom_read(board::Kept::First, first, sizeof first);
            board::eeprom_read(board::Kept::Second, second, sizeof second);
            if (!host.stored(first, second, &tile, &sentence)) {
                board::eeprom_write(host.block(), kSettingsSize);
                writing = Writing::Old;
            }
            say_sentence();
        }
    }
    while (writing == Writing::Nothing && room_to_speak() && board::usart_read(board::kHostUsart, &byte)) {
        switch (host.receive(byte, &tile, now_ms, &sentence)) {
        case Host::Result::Nothing:
            break;
        case Host::Result::Answer:
            say_sentence();
            break;
        case Host::Result::Store:
            board::eeprom_write(host.block(), kSettingsSize);
            writing = Writing::New;
            break;
        }
    }
}

void show(uint32_t now_ms) {
    static uint8_t shown = Tile::kNothing;
    static uint8_t brightness = 0;
    static uint8_t leds = 0;
    const Appearance now = appearance_of(tile, host.blinking(now_ms), now_ms);
    if (now.shown != shown || tile.settings().brightness != brightness) {
        shown = now.shown;
        brightness = tile.settings().brightness;
        const Look look = look_of(tile, shown);
        board::show_segments(look.segments, brightness);
        board::show_colour(look.red, look.green, look.blue);
    }
    if (now.leds != leds) {
        leds = now.leds;
        for (uint8_t i = 0; i < kSides; ++i) {
            board::show_led(i, leds >> i & 1);
        }
    }
}

Health health() {
    Health now = {timing.compute_us(), timing.gap_us(), timing.awake_permille(), board::stack_unused(), {}};
    for (uint8_t i = 0; i < kSides; ++i) {
        now.overruns[i] = board::link_overruns(side_at(i));
    }
    return now;
}

void report(uint32_t now_ms) {
    board::stack_watch();
    if (board::stack_unused() < kLeastStack) {
        telemetry.failed(Error::Stack);
    }
    while (telemetry.next(now_ms) != Telemetry::Next::Nothing && room_to_speak()) {
        if (telemetry.write(tile, health(), now_ms, &sentence)) {
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

} // namespace

void setup() {
    boot = {board::reset_cause(), board::firmware_id()};
    if (boot.reset_cause & board::kWatchdogReset) {
        telemetry.failed(Error::Watchdog, board::hung_at());
    }
    while (!board::stack_watch()) { // so that the first report knows
    }
    board::clock_begin();
    board::links_begin();
    board::face_begin();
    board::usart_begin(board::kHostUsart, kHostBaud);
    board::watchdog_begin();
    write_hello(tile, boot, &sentence);
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
    report(now_ms);
    if (!tile.busy()) {
        sleep();
    }
}
